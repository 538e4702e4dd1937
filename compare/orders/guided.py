"""One approaching contact at a time, in the order that another history shows: is that history permitted?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from ...exact.replay.contact import Touch, contact_of
from ...exact.simulation.policies import Ask, Policy
from ...scenarios.scene import Scene
from ...scenarios.trajectory import Trajectory


@dataclass
class _Course:
    """What one body does in the history followed: groups of contacts, each group in any order."""

    groups: list[list[frozenset[str]]] = field(default_factory=list)
    place: int = 0

    def next(self) -> list[frozenset[str]]:
        return self.groups[self.place] if self.place < len(self.groups) else []

    def meets(self, link: frozenset[str]) -> None:
        """Crosses a contact off; one that is not next leaves the course where it is."""
        group = self.next()
        if link in group:
            group.remove(link)
            if not group:
                self.place += 1


class Guided(Policy):
    """Among the contacts that approach, takes one that comes next for both its bodies in another history.

    Where none does, the first in scene order is taken: the other history is not one that the physics permits from
    there on, which a comparison of the two then shows.

    Args:
        scene: the scene of both.
        history: the run to follow.
        any_order: whether the impulses of one of its events are in no order, as in one time step.
    """

    chooses_order = True

    def __init__(self, scene: Scene, history: Trajectory, any_order: bool = False) -> None:
        self._seen = scene.surfaces
        self._courses = {str(circle.id): _Course() for circle in scene.circles}
        for event in history.events:
            pairs = [frozenset(pair) for pair in event.impulses]
            for together in [pairs] if any_order else [[pair] for pair in pairs]:
                self._add(together)

    def _add(self, pairs: Sequence[frozenset[str]]) -> None:
        """Contacts that come next, in no order among themselves."""
        groups: dict[str, list[frozenset[str]]] = {}
        for pair in pairs:
            for name in pair & self._courses.keys():
                groups.setdefault(name, []).append(pair)
        for name, group in groups.items():
            self._courses[name].groups.append(group)

    def choose(self, approaching: Sequence[Touch], ask: Ask) -> tuple[Touch, ...]:
        """One contact."""
        chosen = next((link for link in approaching if self._is_next(link)), approaching[0])
        self.note(chosen)
        return (chosen,)

    def _is_next(self, link: Touch) -> bool:
        pair = frozenset(contact_of(self._seen, link))
        return all(pair in self._courses[name].next() for name in pair & self._courses.keys())

    def note(self, link: Touch) -> None:
        """A contact has been kicked."""
        pair = frozenset(contact_of(self._seen, link))
        for name in pair & self._courses.keys():
            self._courses[name].meets(pair)
