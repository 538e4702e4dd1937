"""A contact alone, carried out in one go on midpoints, with their deviations: `CentredState` does it in two steps.

The flights are set to their midpoints, `LoneContacts` carries these to the contact and through it, and the deviations
follow in one step of their set (docs/error-bound.md). What is not ordinary is left to the two steps, with nothing
changed.
"""

from __future__ import annotations

from flint import arb

from .body import Body, Flight
from .centred_state import CentredState
from .contact import AtWall, Pair, Touch
from .derivatives import SMALL_WAIT
from .deviations import Deviations
from .errors import UP, Spent
from .lone import LoneContacts


class LoneCentred:
    """Carries out contacts that stand alone, on balls or, where a state keeps deviations in a set, on midpoints.

    Args:
        state: whose bodies fly.
    """

    def __init__(self, state: CentredState) -> None:
        self._state = state
        self._lone = LoneContacts(state)

    def strike(self, link: Touch, bits: int, done: int) -> int | None:
        """As `LoneContacts.strike`."""
        state = self._state
        if not state.centred:
            return self._lone.strike(link, bits, done)
        held = state.ready(link)
        if held is None:
            return None
        movers = [state.bodies[i] for i in link.circles]
        before = [body.flight for body in movers]
        for body in movers:
            held.centre(body)
        time = self._struck(held, link, movers, before, bits, done)
        if time is None:
            for body, flight in zip(movers, before, strict=True):
                body.flight = flight
            return None
        accuracy = state.spread(time, bits)
        for body in movers:
            body.acc = accuracy
            held.show(body, state.instant, state.late)
        state.renew()
        return accuracy

    def _struck(
        self,
        held: Deviations,
        link: Touch,
        movers: list[Body[arb]],
        before: list[Flight[arb]],
        bits: int,
        done: int,
    ) -> arb | None:
        """Carries midpoints and deviations; gives all errors of the instant, or None where that cannot be done."""
        state, lone, unit = self._state, self._lone, held.unit
        lone.met = None
        if lone.strike(link, bits, done) is None:
            return None
        if state.late is None or not abs(float(state.late)) < SMALL_WAIT / 2 * unit:
            return None
        clock, nu, place = movers[0].flight.t, held.errors.bounds.nu, held.place
        try:
            if isinstance(link, Pair):
                i, j = link
                met = lone.met
                if met is None:
                    return None
                one, two = float(clock - before[0].t) / unit, float(clock - before[1].t) / unit
                spread = (nu[place[i]] * (1.0 + abs(one)) + nu[place[j]] * (1.0 + abs(two))) * UP
                hit = held.collision(state, link, met, spread)
                if hit is None:
                    return None
                time = held.ball(held.errors.power_of(hit.steep * spread * UP))
                carried = held.meet(link, movers, hit, (one, two))
            else:
                face, lag = held.face(state, link), float(clock - before[0].t) / unit
                found = held.wall_time(face, nu[place[link[0]]] * (1.0 + abs(lag)) * UP, float(before[0].vx), float(before[0].vy))
                if found is None:
                    return None
                time = found
                carried = held.mirror(face, movers[0], lag)
        except (Spent, OverflowError):
            carried, time = False, None
        if not carried:
            state.loosen()
            return None
        return time
