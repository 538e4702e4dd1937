"""What stands in the way of a shadow, judged by numbers that are told with it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from math import exp2, hypot, sqrt
from typing import TYPE_CHECKING

from ..tangent.impacts import moving

if TYPE_CHECKING:
    from ...scenarios.scene import Scene
    from ...scenarios.trajectory import Trajectory
    from .record import Indices, Record
    from .refine import Refined

GRAZING = 1e-12
"""Share of a diameter below which a contact is a graze whatever the corrections: doubles hardly tell it from a miss."""

DRIFT_SHARE = 0.1
"""Share of the largest correction that a drift of energy must account for, to be what stands in the way."""


class Obstacle(Enum):
    """What stands in the way; the value is what a person reads."""

    SIMULTANEOUS = "several contacts at one instant"
    TOUCHING = "circles that touch at the start"
    GRAZE = "a graze"
    ORDER = "contacts too close in time"
    DRIFT = "energy drift"
    GROWING = "too many growing directions"


@dataclass(frozen=True)
class Blocked:
    """Why no shadow was found.

    Attributes:
        obstacle: of which kind.
        event: of the engine's run, where it stands; None where it is not at one event.
        message: in words, with the numbers that it is judged by.
    """

    obstacle: Obstacle
    event: int | None
    message: str


def units(scene: Scene, record: Record) -> tuple[float, float]:
    """What lengths and velocities are measured by: the mean diameter, and the root of the mean square at the start."""
    sizes = [float(c.r) for c in scene.circles if float(c.r) > 0]
    squares = [flights[0][3] ** 2 + flights[0][4] ** 2 for flights in record.flights.values()]
    return (2 * sum(sizes) / len(sizes) if sizes else 1.0), sqrt(sum(squares) / len(squares)) or 1.0


def drift(scene: Scene, record: Record) -> float:
    """The largest relative change of the energy along an engine's run."""
    masses = {i: 1 / float(scene.circles[i].inverse_mass) for i in moving(scene)}
    now = {i: masses[i] * hypot(*flights[0][3:]) ** 2 for i, flights in record.flights.items()}
    done, start, worst = dict.fromkeys(now, 0), sum(now.values()), 0.0
    for link in record.links:
        for i in (i for i in link if i in now):
            done[i] += 1
            now[i] = masses[i] * hypot(*record.flights[i][done[i]][3:]) ** 2
        worst = max(worst, abs(sum(now.values()) - start))
    return worst / start if start else 0.0


def margin(scene: Scene, record: Record, contact: int) -> float | None:
    """By how many diameters two discs would have to be displaced to miss each other; None for a wall."""
    i, j = record.links[contact]
    circles, time = scene.circles, record.times[contact]
    if j >= len(circles):
        return None
    rows: list[tuple[float, float, float, float]] = []
    for k in (i, j):
        if k not in record.flights:
            rows.append((float(circles[k].x), float(circles[k].y), 0.0, 0.0))
            continue
        turn = sum(k in link for link in record.links[:contact])
        t, x, y, vx, vy = record.flights[k][turn]
        rows.append((x + vx * (time - t), y + vy * (time - t), vx, vy))
    dx, dy, vx, vy = (b - a for a, b in zip(*rows, strict=True))
    speed = hypot(vx, vy)
    reach = float(circles[i].r + circles[j].r)
    return (reach - abs(dx * vy - dy * vx) / speed) / units(scene, record)[0] if speed else None


def not_closed(scene: Scene, record: Record, found: Refined) -> Blocked:
    """Misfits that do not close.

    By a graze, if the correction is as large as what is left to one, or nothing is left to one; by a drift of energy,
    if it accounts for the corrections; else by growth.
    """
    reach = exp2(max(found.corrections)) if found.corrections else 0.0
    if found.missed is not None:
        shallow = margin(scene, record, found.missed)
        if shallow is not None and shallow <= max(reach, GRAZING):
            asked = f", and corrections of {reach:.2g} are asked for: the orbit that is sought passes them by"
            unasked = ", and by the flights that the engine tells they do miss"
            return _shallow(scene, record, found.missed, shallow, asked if found.corrections else unasked)
    for contact in range(len(record.links)):
        depth = margin(scene, record, contact)
        if depth is not None and abs(depth) <= GRAZING:
            return _shallow(scene, record, contact, depth, ", where errors grow without bound")
    if not found.misfits:
        return Blocked(Obstacle.GROWING, None, "the engine's run itself does not lead from one contact to the next")
    told = (
        f"misfits of up to {exp2(found.misfits[0]):.2g} of a diameter ask for corrections of {reach:.2g} and do not "
        f"close (after {len(found.misfits)} rounds they are {exp2(found.misfits[-1]):.2g})"
    )
    # A true orbit keeps its energy. Where the engine's drifts by a share d, speeds differ by d/2, and so do paths, of
    # length speed times time.
    length, speed = units(scene, record)
    lost = drift(scene, record)
    if lost / 2 * max(speed * record.times[-1] / length, 1.0) > DRIFT_SHARE * reach:
        message = f"the engine's energy drifts by {lost:.2g} of itself, which no true orbit does; {told}"
        return Blocked(Obstacle.DRIFT, None, message)
    growing = f"the energy drifts by {lost:.2g} only: errors grow in directions in which nothing draws them back"
    return Blocked(Obstacle.GROWING, None, f"{told}, though {growing}")


def _shallow(scene: Scene, record: Record, contact: int, depth: float, why: str) -> Blocked:
    """A contact that is hardly one."""
    event, (one, other) = record.events[contact], (scene.ids[k] for k in record.links[contact])
    told = f"{one} and {other} meet {max(depth, 0.0):.2g} of a diameter from missing each other"
    return Blocked(Obstacle.GRAZE, event, f"event {event}: {told}{why}")


def other_history(scene: Scene, record: Record, run: Trajectory, theirs: Record) -> Blocked | None:
    """Where a true history has another contact than an engine's; None if each circle has the same ones, in order.

    Args:
        theirs: the true run as a record, of as many contacts at least.
    """
    if not run.certified:
        message = f"the run of the start that was found is not certified: {run.stop.message}"
        return Blocked(Obstacle.SIMULTANEOUS, None, message)
    wanted, links = record.links, theirs.links[: len(record.links)]
    streams = [{i: [link for link in told if i in link] for i in record.flights} for told in (links, wanted)]
    if streams[0] == streams[1]:
        return None
    for k, link in enumerate(wanted):
        for i in (i for i in link if i in record.flights):
            turn = sum(i in other for other in wanted[:k])
            got = streams[0][i][turn] if turn < len(streams[0][i]) else None
            if got != link:
                return _parted(scene, record, theirs, k, i, got)
    raise AssertionError("streams that differ have a first difference")


def _parted(scene: Scene, record: Record, theirs: Record, contact: int, i: int, got: Indices | None) -> Blocked:
    """Circle i has a contact in the engine's run, and another one, or none, in the true one."""
    ids, link, event = scene.ids, record.links[contact], record.events[contact]
    turn = sum(i in other for other in record.links[:contact])
    place = [k for k, other in enumerate(theirs.links) if i in other][turn : turn + 1]
    depths = [margin(scene, record, contact), *(margin(scene, theirs, k) for k in place)]
    shallow = min((depth for depth in depths if depth is not None), default=None)
    other = "meets nothing more" if got is None else f"meets {ids[got[got[0] == i]]}"
    told = (
        f"event {event}: {ids[i]} meets {ids[link[link[0] == i]]} in the engine's run; in the true history of the "
        f"start that was found it {other}"
    )
    if shallow is not None and shallow < SHALLOW:
        return Blocked(Obstacle.GRAZE, event, f"{told}; a graze, {shallow:.2g} of a diameter from a miss")
    return Blocked(Obstacle.ORDER, event, told)


SHALLOW = 0.05
"""Share of a diameter below which a contact that only one history has is called a graze."""
