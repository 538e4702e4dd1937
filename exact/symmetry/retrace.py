"""The way back of a reversed run: which of its events are those of the way out, in reverse.

After the one reversal at time T, a circle retraces its way as long as each block that it takes part in undoes the
last block of the way out that is not undone. An impulse is a linear map of velocities that is its own inverse at
the same places, so, by induction over the blocks, the circle's flight is then that of the way out with its velocity
negated, and every contact of two such circles comes at 2 T less the time at which it parted on the way out. What was
one instant on the way out is one on the way back; what was earlier is later.
"""

from __future__ import annotations

from collections.abc import Iterable

from ..predicates.hits import BeforeTime, Discriminant, Moment, Sooner
from ..predicates.question import Question
from ..replay.contact import Entry, Link, Touch
from .past import FLIP, Block, Past


class Retrace:
    """What the way out tells of the way back.

    Args:
        past: the blocks, as they are logged.
        touching: the contacts at gap zero at time 0.

    Attributes:
        levels: after the reversal, for each circle: how many blocks of its way out are not undone yet; None once it
            has left its way. Empty before the reversal.
    """

    def __init__(self, past: Past, touching: Iterable[Touch]) -> None:
        self.past = past
        self.levels: list[int | None] = []
        self._gathered: dict[int, frozenset[Touch]] = {0: frozenset(touching)}
        self._grazes: set[tuple[Link, tuple[int, ...]]] = set()

    # -- noting

    def gathered(self, instant: int, links: Iterable[Touch]) -> None:
        """Notes what stands at gap zero at an instant of the way out, once its impulses are done."""
        if not self.levels:
            self._gathered[instant] = self._gathered.get(instant, frozenset()) | frozenset(links)

    def grazes(self, link: Link) -> bool:
        """Notes a pair proved to graze on its flights of now; tells whether that is new, and of use on the way back."""
        graze = link, self._heights(link)
        new = -1 not in graze[1] and graze not in self._grazes
        if new:
            self._grazes.add(graze)
        return new

    def note(self, blocks: Iterable[Block]) -> None:
        """Notes new blocks of the log."""
        for block in blocks:
            if block.kind == FLIP:
                self.levels = self.levels or [0] * self.past.n
                self.levels = [block.places.get(i, level) for i, level in enumerate(self.levels)]
            elif self.levels:
                self._undo(block)

    def _undo(self, block: Block) -> None:
        met = [self._undoing(i) for i in block.places]
        whole = met[0]
        if whole is not None and all(other is whole for other in met):
            same = whole.links == block.links and whole.places.keys() == block.places.keys()
            if same and not block.kind and not whole.kind:
                for i in block.places:
                    self.levels[i] = whole.places[i]
                return
        for i in block.places:
            self.levels[i] = None

    def _undoing(self, i: int) -> Block | None:
        """The last block of a circle's way out that is not undone yet."""
        level = self.levels[i]
        return self.past.rows[i][level - 1] if level else None

    # -- asking

    @property
    def home(self) -> bool:
        """Whether every circle has undone its whole way, so that the state is the first one with velocities negated."""
        movable = self.past.movable
        return bool(self.levels) and all(level == 0 for i, level in enumerate(self.levels) if movable[i])

    def sign(self, question: Question) -> int | None:
        """What the way out tells of a question asked on the way back; None if nothing."""
        if isinstance(question, Discriminant):
            return 0 if self._grazed(question.link) else None
        if not self.levels:
            return None
        if isinstance(question, Sooner):
            first, second = self._parted(question.first), self._parted(question.second)
            return None if first is None or second is None else (first < second) - (first > second)
        if isinstance(question, BeforeTime) and question.time is None:
            instant = self._parted(question.moment)
            return None if instant is None else -1 if instant > 0 else 0
        return None

    def _heights(self, link: Link) -> tuple[int, ...]:
        """How many blocks of the way out the two have behind them; -1 for a circle that has left it."""

        def height(i: int) -> int:
            if not self.levels:
                return len(self.past.rows[i])
            level = self.levels[i]
            return -1 if level is None else level

        return tuple(height(i) for i in link.circles)

    def _grazed(self, link: Link) -> bool:
        heights = self._heights(link)
        return -1 not in heights and (link, heights) in self._grazes

    def _parted(self, moment: Moment) -> int | None:
        """The instant of the way out at which the two of a contact, on their flights of now, stood at gap zero."""
        link = moment.link
        if isinstance(link, Entry):
            return None
        latest, met = 0, self._gathered[0]
        for i in link.circles:
            if self.past.movable[i]:
                level = self.levels[i]
                if level is None:
                    return None
                if level:
                    block = self.past.rows[i][level - 1]
                    if block.instant > latest:
                        latest, met = block.instant, self._gathered.get(block.instant, frozenset())
                    if block.instant == latest:
                        met = met | block.among
        return latest if link in met else None
