"""Which of several approaching contacts push: the linear complementarity problem of one round, by criss-cross.

The impulses s of a round obey 0 <= s, complementary to G s + 2 u >= 0: each contact separates at least as fast as
it approached, and one that separates faster is not pushed (G and u as in `State.contact_system`). G is positive
semidefinite, hence sufficient, so the least-index criss-cross method ends after finitely many exchanges whatever
the degeneracy (Klafszky and Terlaky, Linear Algebra Appl. 1992; den Hertog, Roos, Terlaky, 1993), and the
velocities that come out are unique though the impulses need not be.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ..numbers.undecided import BudgetSpent
from ..predicates.impulses import Pivot, Share, Slack, Strength
from ..predicates.question import Question
from ..replay.contact import Touch

Ask = Callable[[Question], int]

ENDLESS = "rounds without end: rounded numbers contradict each other on which of {} contacts at one instant push"


def pushing_contacts(approaching: Sequence[Touch], ask: Ask) -> tuple[Touch, ...]:
    """Those of the approaching contacts that push, in the order given.

    Args:
        approaching: contacts at one instant, each of which approaches.
        ask: decides the sign of a question.

    Raises:
        BudgetSpent: if a set of contacts comes a second time, or none pushes, which no true signs lead to.
        whatever `ask` raises when a sign is not known.
    """
    if len(approaching) == 1:
        return tuple(approaching)
    basis: list[Touch] = []
    seen: set[tuple[Touch, ...]] = set()
    while tuple(basis) not in seen:
        seen.add(tuple(basis))
        pushing = []
        for link in approaching:
            if link in basis:
                sign = ask(Strength(tuple(basis), link))
                if sign > 0:
                    pushing.append(link)
            else:
                sign = ask(Slack(tuple(basis), link)) if basis else -1
            if sign < 0:
                _exchange(basis, link, approaching, ask)
                break
        else:
            if pushing:
                return tuple(pushing)
            break
    raise BudgetSpent(ENDLESS.format(len(approaching)))


def _exchange(basis: list[Touch], link: Touch, order: Sequence[Touch], ask: Ask) -> None:
    """One criss-cross exchange at the first infeasible contact; none where the signs leave none."""
    if link in basis:
        basis.remove(link)
        return
    if basis and ask(Pivot(tuple(basis), link)) == 0:
        sharing = (other for other in order if other in basis and ask(Share(tuple(basis), other, entering=link)) > 0)
        leaving = next(sharing, None)
        if leaving is None:
            return
        basis.remove(leaving)
    basis.append(link)
    basis.sort(key=order.index)
