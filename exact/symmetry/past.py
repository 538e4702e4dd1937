"""The causal past of a run as a graph: for each circle, the rounds of impulses that it took part in, in order."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from ..replay.contact import Touch
from ..replay.steps import Flip, Go, Kick, Step, Take

FLIP, TAKE = "flip", "take"


class Block:
    """What one round did to circles that hang together through movable circles: one node of the graph.

    Attributes:
        number: its place among all blocks, in the order of the log.
        instant: the number of the instant that it belongs to.
        kind: "" for impulses; FLIP for the negation of one circle's velocity, TAKE for its capture.
        among: the contacts whose law it is (see `Kick`).
        links: those of them that push.
        places: for each movable circle in it, its place in that circle's row.
    """

    __slots__ = ("among", "instant", "kind", "links", "number", "places")

    def __init__(
        self, number: int, instant: int, among: frozenset[Touch], links: frozenset[Touch], kind: str = ""
    ) -> None:
        self.number = number
        self.instant = instant
        self.kind = kind
        self.among = among
        self.links = links
        self.places: dict[int, int] = {}


class Past:
    """The graph, brought up to the end of the log whenever it is asked for.

    Args:
        movable: for each circle, whether its mass is finite. A fixed circle has data and no past.
        steps: the log, which only grows.

    Attributes:
        rows: for each circle, its blocks in order.
    """

    def __init__(self, movable: Sequence[bool], steps: Sequence[Step]) -> None:
        self.movable = tuple(movable)
        self.n = len(self.movable)
        self.rows: list[list[Block]] = [[] for _ in self.movable]
        self._steps = steps
        self._done = 0
        self._starts: list[tuple[int, int]] = [(0, 0)]
        self._place = 0
        self._count = 0

    def begin(self, instant: int) -> None:
        """Told, before the steps of an instant, its number."""
        self._starts.append((len(self._steps), instant))

    def catch_up(self) -> list[Block]:
        """Adds the steps that the log has gained; the blocks that they make."""
        blocks: list[Block] = []
        starts = self._starts
        while self._done < len(self._steps):
            while self._place + 1 < len(starts) and starts[self._place + 1][0] <= self._done:
                self._place += 1
            blocks += self._blocks(self._steps[self._done], starts[self._place][1])
            self._done += 1
        return blocks

    def _blocks(self, step: Step, instant: int) -> list[Block]:
        if isinstance(step, Go):
            return []
        if isinstance(step, Kick):
            if len(step.among) == 1:
                alone = frozenset(step.among)
                return [self._add(instant, alone, alone, step.among[0].circles)]
            pushing = set(step.links)
            return [self._add(instant, among, among & pushing, bodies) for bodies, among in self._apart(step.among)]
        if isinstance(step, Take):
            return [self._add(instant, frozenset(), frozenset(), (step.body,), TAKE)]
        assert isinstance(step, Flip)
        movers = (i for i in range(self.n) if self.movable[i])
        return [self._add(instant, frozenset(), frozenset(), (i,), FLIP) for i in movers]

    def _add(
        self, instant: int, among: frozenset[Touch], links: frozenset[Touch], bodies: Iterable[int], kind: str = ""
    ) -> Block:
        block = Block(self._count, instant, among, links, kind)
        self._count += 1
        for i in bodies:
            if self.movable[i]:
                block.places[i] = len(self.rows[i])
                self.rows[i].append(block)
        return block

    def _apart(self, links: Iterable[Touch]) -> list[tuple[set[int], frozenset[Touch]]]:
        """Contacts that share movable circles, directly or through others; no block reaches beyond them."""
        groups: list[tuple[set[int], set[Touch]]] = []
        for link in links:
            bodies, mine = {i for i in link.circles if self.movable[i]}, {link}
            apart: list[tuple[set[int], set[Touch]]] = []
            for others, theirs in groups:
                if others & bodies:
                    bodies, mine = bodies | others, mine | theirs
                else:
                    apart.append((others, theirs))
            groups = [*apart, (bodies, mine)]
        return [(bodies, frozenset(mine)) for bodies, mine in groups]
