"""One approaching contact at a time, in the order that another history shows: is that history permitted?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from ...exact.replay.contact import Touch, touch_of
from ...exact.simulation.policies import Ask, Policy
from ...scenarios.scene import Scene
from ...scenarios.trajectory import Trajectory


@dataclass
class _Course:
    """What one body does in the history followed: groups of contacts, each group in any order."""

    groups: list[list[Touch]] = field(default_factory=list)
    place: int = 0

    def next(self) -> list[Touch]:
        return self.groups[self.place] if self.place < len(self.groups) else []

    def meets(self, link: Touch) -> None:
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
        places = {name: place for place, name in enumerate(scene.ids)}
        self._courses = [_Course() for _ in scene.circles]
        for event in history.events:
            links = [touch_of(scene, places[first], places[second]) for first, second in event.impulses]
            for together in [links] if any_order else [[link] for link in links]:
                self._add(together)

    def _add(self, links: Sequence[Touch]) -> None:
        """Contacts that come next, in no order among themselves."""
        groups: dict[int, list[Touch]] = {}
        for link in links:
            for i in link.circles:
                groups.setdefault(i, []).append(link)
        for body, group in groups.items():
            self._courses[body].groups.append(group)

    def choose(self, approaching: Sequence[Touch], ask: Ask) -> tuple[Touch, ...]:
        """One contact."""
        chosen = next((link for link in approaching if self._is_next(link)), approaching[0])
        self.note(chosen)
        return (chosen,)

    def _is_next(self, link: Touch) -> bool:
        return all(link in self._courses[i].next() for i in link.circles)

    def note(self, link: Touch) -> None:
        """A contact has been kicked."""
        for i in link.circles:
            self._courses[i].meets(link)
