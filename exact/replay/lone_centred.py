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
from .deviations import Deviations
from .errors import MOST, UP, Leg, Spent
from .lone import LoneContacts


def lone_contacts(state: CentredState) -> LoneContacts | LoneCentred:
    """What carries out contacts that stand alone: on balls, or on midpoints where deviations are kept in a set."""
    return LoneCentred(state) if state.centred else LoneContacts(state)


class LoneCentred:
    """Carries out contacts that stand alone, on midpoints.

    Args:
        state: whose bodies fly.
    """

    def __init__(self, state: CentredState) -> None:
        self._state = state
        self._lone = LoneContacts(state)

    def strike(self, link: Touch, bits: int, done: int) -> int | None:
        """As `LoneContacts.strike`."""
        state = self._state
        held = state.ready(link)
        if held is None:
            return None
        movers = [state.bodies[i] for i in link.circles]
        before = [body.flight for body in movers]
        for body in movers:
            held.centre(body)
        self._lone.met = None
        time = None
        if self._lone.strike(link, bits, done) is not None and held.stands_near(state.late):
            try:
                if isinstance(link, Pair):
                    time = self._meet(held, link, movers, before)
                else:
                    time = self._rebound(held, link, movers[0], before[0])
            except (Spent, OverflowError):
                state.loosen()
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

    def _meet(self, held: Deviations, link: Pair, movers: list[Body[arb]], before: list[Flight[arb]]) -> arb | None:
        """Carries the deviations of two circles; gives all errors of the instant, or None, with nothing changed.

        Raises:
            Spent: if they are too large now.
        """
        met = self._lone.met
        if met is None:
            return None
        weights = held.weights[link.a], held.weights[link.b]
        i, j, nu = held.place[link.a], held.place[link.b], held.errors.bounds.nu
        clock, unit = movers[0].flight.t, held.unit
        lags = float(clock - before[0].t) / unit, float(clock - before[1].t) / unit
        spread = (nu[i] * (1.0 + abs(lags[0])) + nu[j] * (1.0 + abs(lags[1]))) * UP
        hit = held.collision(self._state, link, met, spread)
        if hit is None:
            return None
        time = held.ball(held.errors.power_of(hit.steep * spread * UP))
        held.errors.meet(i, j, lags, weights, hit, held.recentre(movers))
        if not (nu[i] < MOST and nu[j] < MOST):
            raise Spent
        return time

    def _rebound(self, held: Deviations, link: AtWall, body: Body[arb], before: Flight[arb]) -> arb | None:
        """As `_meet`, of a circle and a wall."""
        face, lag = held.face(self._state, link), float(body.flight.t - before.t) / held.unit
        i, nu = held.place[body.index], held.errors.bounds.nu
        time = held.wall_time(face, nu[i] * (1.0 + abs(lag)) * UP, float(before.vx), float(before.vy))
        if time is None:
            return None
        held.errors.fly(Leg(i, lag, face.xx, face.xy, face.yy), face.off, held.recentre((body,)))
        if not nu[i] < MOST:
            raise Spent
        return time
