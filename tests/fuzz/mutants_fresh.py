"""Faults that the engine never had, as a programmer could make them: over all that decides what happens."""

from __future__ import annotations

from fuzz.mutant import Mutant

SIMULATION, CERTIFIED = "exact/simulation", "exact/certified"
INSTANT, ROUNDS, LOOP = (f"{SIMULATION}/{name}.py" for name in ("instant", "policies", "loop"))
GATHERING = INSTANT
MEETINGS = DECIDER = f"{CERTIFIED}/certified_decider.py"
QUEUE = PREDICTION = f"{SIMULATION}/prediction.py"
HISTORY = f"{SIMULATION}/decider.py"
ISOMETRY = "exact/isometry.py"
LOG = PAST = RETRACE = HELD = "exact/log_symmetry.py"
CASCADE, FILTER = f"{CERTIFIED}/cascade.py", f"{CERTIFIED}/filtered.py"
FILTERED, BALLS, LIVE = (
    "exact/certified/filtered.py",
    "exact/replay/ball_state.py",
    "exact/replay/refinable.py",
)
PUSHING, MOTION, BALL = "exact/simulation/policies.py", "exact/exact_motion.py", "exact/numbers/ball.py"
PLAIN = "floating/plain_meetings.py"
TOO_SMALL = " * 2.0**-20"

CONTACTS = (
    Mutant(
        "alone_beside_lasting", INSTANT,
        "if len(instant.hits) == 1 and not instant.touches and not self.touching:",
        "if len(instant.hits) == 1 and not instant.touches:",
        "one hit is taken to be alone although contacts last",
    ),
    Mutant(
        "alone_beside_grazes", INSTANT,
        "if len(instant.hits) == 1 and not instant.touches and not self.touching:",
        "if len(instant.hits) == 1 and not self.touching:",
        "one hit is taken to be alone although others graze at its instant",
    ),
    Mutant(
        "every_touch_lasts", INSTANT,
        "        if self.decider.ask(RelativeSpeed(link)) == 0:\n            return True\n",
        "        return True\n",
        "a graze is taken for a lasting contact",
    ),
    Mutant(
        "no_wall_lasts", INSTANT,
        "            return self._sides.pull(*link[:2]) == 0\n",
        "            return False\n",
        "a circle that slides along a wall is forgotten to touch it",
    ),
    Mutant(
        "lasting_never_ends", INSTANT,
        "                self.touching.discard(link)\n\n    # -- 2",
        "                pass\n\n    # -- 2",
        "contacts that part are still taken to last",
    ),
    Mutant(
        "parting_at_start_lasts", INSTANT,
        "if sign == 0 and self._lasts(link):\n            self",
        "if self._lasts(link):\n            self",
        "a wall that a circle leaves at time 0 is taken to last",
    ),
    Mutant(
        "sets_by_first_circle", INSTANT,
        "struck.sort(key=lambda one: scene_order(one[0]))",
        "struck = list(struck)",
        "sets of contacts act in the order of their first circle, not of their first contact that approaches",
    ),
    Mutant(
        "coupled_by_last_set", INSTANT,
        "coupled = coupled or self._coupled(rounds)",
        "coupled = self._coupled(rounds)",
        "whether the order matters is told of the last set of contacts alone",
    ),
    Mutant(
        "coupled_reversed", INSTANT,
        "self.decider.ask_cheaply(Coupling(first, second)) != 0",
        "(self.decider.ask_cheaply(Coupling(first, second)) or 0) > 0",
        "pushes that share a circle and oppose each other count as independent",
    ),
    Mutant(
        "grown_once", ROUNDS,
        "            grown = bool(reached)\n",
        "            grown = False\n",
        "contacts two circles away do not hang together",
    ),
    Mutant(
        "stale_signs", ROUNDS,
        "told[link] if link in apart else None",
        "told[link]",
        "a contact whose circle was kicked is not asked anew",
    ),
    Mutant(
        "all_part_at_once", ROUNDS,
        "among = chosen if policy.chooses_order else tuple(coming)",
        "among = tuple(coming)",
        "in order too, every approaching contact counts as parted after the first kick",
    ),
    Mutant(
        "only_kicked_take_part", ROUNDS,
        "taking_part.update(coming)",
        "taking_part.update(policy.choose(coming, ask) if not policy.chooses_order else coming)",
        "a contact that approaches but is not pushed is no part of the event",
    ),
    Mutant(
        "two_always_push", PUSHING,
        "if len(approaching) == 1:",
        "if len(approaching) <= 2:",
        "two contacts at once always both push",
    ),
    Mutant(
        "no_push_pushes", PUSHING,
        "                if sign > 0:\n",
        "                if sign >= 0:\n",
        "a contact of strength zero counts as pushing",
    ),
    Mutant(
        "dependent_not_seen", PUSHING,
        "if basis and ask(Pivot(tuple(basis), link)) == 0:",
        "if False:",
        "a contact that depends on those that push joins them",
        why_it_survives="the branch is dead: the speeds wanted are twice those at hand, J v, so a contact whose "
        "arms depend on those that push has no slack at all, and is never exchanged",
    ),
    Mutant(
        "wrong_one_leaves", PUSHING,
        "entering=link)) > 0",
        "entering=link)) < 0",
        "of dependent contacts the wrong one leaves",
        why_it_survives="as dependent_not_seen: a dependent contact is never exchanged",
    ),
    Mutant(
        "slack_above_zero", "exact/question.py",
        "        slack = speed_change(speeds[-1])\n",
        "        slack = speeds[-1]\n",
        "whether a contact separates fast enough is held against half its speed",
    ),
    Mutant(
        "last_in_order", "exact/simulation/policies.py",
        "return (approaching[0],)",
        "return (approaching[-1],)",
        "the last in scene order is kicked, not the first",
    ),
    Mutant(
        "drawn_without_choice", "exact/simulation/policies.py",
        "if self._random is None or len(approaching) == 1:",
        "if self._random is None:",
        "a number is drawn where there is no choice, so later orders differ",
    ),
    Mutant(
        "together_one_mass", "exact/replay/state.py",
        "{i: (bodies[i].w * jx, bodies[i].w * jy) for i, jx, jy in mine if not circles[i].fixed}",
        "{i: (bodies[mine[0][0]].w * jx, bodies[mine[0][0]].w * jy) for i, jx, jy in mine if not circles[i].fixed}",
        "impulses together are reckoned with the mass of the first circle of a contact",
    ),
    Mutant(
        "touch_at_start_of_walls", "scenarios/neighbours.py",
        "return sign == 0 and wall.side(circle.x, circle.y) == height.sign()\n",
        "return sign == 0 and height.sign() > 0\n",
        "a circle that touches a wall from its other side is not seen at time 0",
    ),
)  # fmt: skip

GATHERING = (
    Mutant(
        "limit_leaves_out", GATHERING,
        "if limit is not None and place > 0:",
        "if limit is not None and place >= 0:",
        "what falls exactly on a limit is left out",
    ),
    Mutant(
        "straddling_is_late", GATHERING,
        "rivals = [rival for rival in found if rival.low <= limit]",
        "rivals = [rival for rival in found if rival.high <= limit]",
        "an arrival whose bounds straddle the limit counts as later",
    ),
    Mutant(
        "limit_in_doubles", GATHERING,
        "        if arrival.high < low:\n",
        "        if arrival.low < low:\n",
        "an arrival that may come just after a limit counts as before it",
    ),
    Mutant(
        "no_reversal_at_the_end", GATHERING,
        "(until is None or flip <= until)",
        "(until is None or flip < until)",
        "a reversal at the very end is left out",
    ),
    Mutant(
        "split_not_seen", INSTANT,
        "if events_left is not None and len(done.events) == events_left:",
        "if events_left is not None and len(done.events) > events_left:",
        "the reversal follows although the limit on events is reached",
    ),
    Mutant(
        "grazes_not_chained", GATHERING,
        "reached = self._reached(reached.union(graze.link.circles))",
        "reached = self._reached(reached)",
        "a graze that only another graze links to the instant is no part of it",
    ),
    Mutant(
        "grazes_not_through_lasting", GATHERING,
        "        grown = bool(lasting)\n",
        "        grown = False\n",
        "a graze that only a lasting contact links to the instant is no part of it",
    ),
    Mutant(
        "grazes_not_at_counted_reversal", GATHERING,
        "return len(self.history.records) + 1 == due and any(arrival.link.pushes for arrival in chosen)",
        "return False",
        "at a reversal after some events the grazes elsewhere are not gathered",
        why_it_survives="a reversal sends back what parts at its instant, and that shares circles only with "
        "contacts that were gathered: the other grazes of the instant still graze; what stands "
        "is asked once more",
    ),
    Mutant(
        "grazes_pass_as_hits", MEETINGS,
        "low=low, high=high, certain=True, time=time, graze=disc == 0)",
        "low=low, high=high, certain=True, time=time, graze=False)",
        "a graze that is settled counts as a hit",
    ),
    Mutant(
        "grazes_settled_away", MEETINGS,
        "        if disc is None or disc < 0:\n            return None\n",
        "        if disc is None or disc <= 0:\n            return None\n",
        "a graze that is settled counts as a miss",
    ),
    Mutant(
        "grazes_predicted_as_hits", MEETINGS,
        "self.predictor.push(self._meeting(link, disc), link, disc == 0)",
        "self.predictor.push(self._meeting(link, disc), link)",
        "a graze that is certain at once is queued as a hit",
    ),
    Mutant(
        "grazes_of_time_0", LOOP,
        "touches={link: sign for link, sign in signs.items() if sign >= 0},",
        "touches={link: sign for link, sign in signs.items() if sign > 0},",
        "what grazes at time 0 is no part of that instant",
    ),
    Mutant(
        "doubtful_dropped", MEETINGS,
        "            self.predictor.push_doubtful(link)\n        elif disc >= 0:\n",
        "            return\n        elif disc >= 0:\n",
        "a meeting that balls cannot tell from a miss is dropped",
    ),
    Mutant(
        "doubtful_too_late", PREDICTION,
        "gap = gap / (state.root(dx * dx + dy * dy) + reach)",
        "gap = gap / (reach + reach)",
        "a doubtful meeting is looked at too late: |d| is taken for the reach",
    ),
    Mutant(
        "doubtful_speed_squared", PREDICTION,
        "speed = state.root(vx * vx + vy * vy)",
        "speed = vx * vx + vy * vy",
        "a doubtful meeting of slow circles is looked at too late: speed squared is taken for speed",
    ),
    Mutant(
        "stale_partner", QUEUE,
        "return len(serials) == 1 or bodies[link[1]].serial == serials[1]",
        "return True",
        "an arrival is fresh although the second circle has turned away",
    ),
    Mutant(
        "wall_ends_early", QUEUE,
        "                a.until = high\n",
        "                a.until = low - (high - low) * 2**40\n",
        "what comes shortly before a wall is left out with what comes after it",
    ),
    Mutant(
        "wall_of_an_old_flight", "exact/simulation/prediction.py",
        "            a.until = inf\n",
        "",
        "the wall that ended the flight before ends the new one too",
    ),
    Mutant(
        "one_rival", QUEUE,
        "        while heap and heap[0][0] <= bar:\n            other",
        "        while heap and heap[0][0] <= bar and len(found) < 2:\n            other",
        "of the arrivals that may be first only two are looked at",
    ),
    Mutant(
        "bar_at_lower_bound", QUEUE,
        "bar = min(bar, arrival.high)",
        "bar = min(bar, arrival.high if arrival.high == inf else arrival.low)",
        "arrivals within the error of the first are left in the queue",
    ),
    Mutant(
        "queued_grazes_forgotten", QUEUE,
        "return [entry for entry in self._heap if isinstance(entry, Arrival) and entry.graze]",
        "return []",
        "grazes in the queue at a reversal at a set time are forgotten",
        why_it_survives="nothing parts where only a set time makes the instant, so a reversal sends nothing "
        "back there, and grazes still graze; what stands is asked once more",
    ),
    Mutant(
        "points_meet", PREDICTION,
        "if link in standing or (link.pushes and a.index in self.points and b.index in self.points):",
        "if link in standing:",
        "two points meet",
    ),
    Mutant(
        "points_pass_pockets", PREDICTION,
        "(link.pushes and a.index in self.points and b.index in self.points)",
        "(a.index in self.points and b.index in self.points)",
        "a point does not come to a pocket whose number is that of a point",
    ),
    Mutant(
        "standing_predicted", PREDICTION,
        "if link in standing or (link.pushes and a.index in self.points and b.index in self.points):",
        "if link.pushes and a.index in self.points and b.index in self.points:",
        "contacts that stand at gap zero are predicted",
    ),
    Mutant(
        "gone_predicted", PREDICTION,
        "if b.index not in gone]",
        "if True]",
        "captured circles are still met",
    ),
    Mutant(
        "lasting_predicted", LOOP,
        "return {*done.standing, *lasting} if lasting else done.standing",
        "return done.standing",
        "lasting contacts are predicted",
        why_it_survives="costs time: that two which move together do not approach is asked, and answered, once more",
    ),
)  # fmt: skip

ENTRIES = (
    Mutant(
        "sent_in_unseen", INSTANT,
        "if (self._moves_in(link, link in rims, done) if link.circle in done.moved else link in arriving)",
        "if link in arriving",
        "entries are told before the contacts of their instant act",
    ),
    Mutant(
        "arriving_enters_anyway", INSTANT,
        "if (self._moves_in(link, link in rims, done) if link.circle in done.moved else link in arriving)",
        "if link in arriving or (link.circle in done.moved and self._moves_in(link, link in rims, done))",
        "a centre enters although a contact at the rim turns it away",
    ),
    Mutant(
        "along_the_rim_enters", INSTANT,
        "        return closing < 0\n",
        "        return closing <= 0\n",
        "a centre that moves along the rim enters",
    ),
    Mutant(
        "captured_still_touches", INSTANT,
        "                self.touching.discard(contact)\n        for contact",
        "                pass\n        for contact",
        "a captured circle still carries its lasting contacts",
    ),
    Mutant(
        "captured_stays_in_play", INSTANT,
        "        self.gone.add(i)\n",
        "",
        "captured circles stay in play, at rest",
    ),
    Mutant(
        "rims_forgotten_by_reversal", INSTANT,
        "rims = instant.rims | {link for link in before.standing if not can_push(link)}",
        "rims = instant.rims",
        "a reversal forgets the rims at which the contacts before it left centres",
        why_it_survives="costs time: a reversal moves every circle, so every rim is looked at anew",
    ),
    Mutant(
        "standing_on_rim_at_start", LOOP,
        "arrivals=tuple(link for link in rims if decider.ask(Closing(link)) < 0),",
        "arrivals=tuple(link for link in rims if decider.ask(Closing(link)) <= 0),",
        "a centre at rest on a rim at time 0 enters",
    ),
    Mutant(
        "rim_by_place_alone", INSTANT,
        "if not known and (closing >= 0 or self.decider.ask(Rim(link)) != 0):",
        "if not known and (closing >= 0 or self.decider.ask(Rim(link)) > 0):",
        "a circle struck inside of a pocket enters it once more",
    ),
)  # fmt: skip

REVERSAL = (
    Mutant(
        "reversal_keeps_touches", INSTANT,
        "touches = {link: -sign for link, sign in instant.touches.items() if self.gone.isdisjoint(link.circles)}",
        "touches = {link: sign for link, sign in instant.touches.items() if self.gone.isdisjoint(link.circles)}",
        "a reversal at time 0 does not turn round what parts there",
        why_it_survives="touches part at time 0 only; a reversal there needs an event, whose standing contacts "
        "hold them all",
    ),
    Mutant(
        "reversal_forgets_parted", INSTANT,
        "touches.update((link, -sign) for link, sign in before.standing.items() if can_push(link))",
        "touches.update((link, sign) for link, sign in before.standing.items() if can_push(link))",
        "a reversal does not send back what has just parted",
    ),
    Mutant(
        "reversal_forgets_grazes", INSTANT,
        "self._contacts(hits, {link: sign for link, sign in touches.items() if sign >= 0}, instant, done)",
        "self._contacts(hits, {}, instant, done)",
        "grazes at a reversal are no part of what it makes approach",
    ),
    Mutant(
        "level_skipped", RETRACE,
        "self.levels[i] = whole.places[i]",
        "self.levels[i] = max(whole.places[i] - 1, 0)",
        "one impulse undone counts as two",
    ),
    Mutant(
        "level_not_taken_off", RETRACE,
        "self.levels[i] = whole.places[i]",
        "self.levels[i] = whole.places[i] + 1",
        "an impulse undone still waits to be undone",
    ),
    Mutant(
        "undone_by_anything", RETRACE,
        "same = whole.links == block.links and whole.places.keys() == block.places.keys()",
        "same = whole.places.keys() == block.places.keys()",
        "other impulses among the same circles count as undoing them",
    ),
    Mutant(
        "undone_by_one", RETRACE,
        "if whole is not None and all(other is whole for other in met):",
        "if whole is not None:",
        "the block that only the first circle's way has next counts as undone by all",
    ),
    Mutant(
        "gathered_of_time_0", RETRACE,
        "latest, met = block.instant, self._gathered.get(block.instant, frozenset())",
        "latest, met = block.instant, self._gathered[0]",
        "what stood at gap zero at an instant is looked up at time 0",
    ),
    Mutant(
        "gathered_not_asked", RETRACE,
        "return latest if link in met else None",
        "return latest",
        "any two are taken to have stood at gap zero where the later of them was struck",
    ),
    Mutant(
        "earlier_of_two", RETRACE,
        "if block.instant > latest:",
        "if latest == 0 or block.instant < latest:",
        "a contact of the way out is dated by the earlier of its circles' instants",
    ),
    Mutant(
        "home_by_one", RETRACE,
        "return bool(self.levels) and all(level == 0",
        "return bool(self.levels) and any(level == 0",
        "home is told when one circle is home",
    ),
    Mutant(
        "way_back_in_order", RETRACE,
        "(first < second) - (first > second)",
        "(first > second) - (first < second)",
        "what was earlier on the way out is earlier on the way back",
    ),
    Mutant(
        "all_at_the_return", RETRACE,
        "-1 if instant > 0 else 0",
        "0",
        "any contact undone falls on the return",
        why_it_survives="an event at the return belongs to the run just as one before it",
    ),
    Mutant(
        "grazed_once", RETRACE,
        "return -1 not in heights and (link, heights) in self._grazes",
        "return -1 not in heights and any(link == other for other, _ in self._grazes)",
        "a pair that has grazed once is said to graze on later flights",
    ),
    Mutant(
        "instants_off_by_one", PAST,
        "starts[self._place + 1] <= self._done",
        "starts[self._place + 1] < self._done",
        "the first step of an instant is put to the one before",
        why_it_survives="the first step of an instant is a Go, which makes no block; at time 0 there is no "
        "instant before",
    ),
    Mutant(
        "wrong_instant_gathered", DECIDER,
        "self.retrace.gathered(self._instant,",
        "self.retrace.gathered(self._instant + 2,",
        "what stands at gap zero is noted of the next instant",
    ),
)  # fmt: skip

SYMMETRY = (
    Mutant(
        "masses_ignored", ISOMETRY,
        "self.kinds = [(constant(c.r), constant(c.inverse_mass)) for c in scene.circles]",
        "self.kinds = [(constant(c.r), constant(c.r)) for c in scene.circles]",
        "an isometry maps circles of other masses",
    ),
    Mutant(
        "radii_ignored", ISOMETRY,
        "self.kinds = [(constant(c.r), constant(c.inverse_mass)) for c in scene.circles]",
        "self.kinds = [(constant(c.inverse_mass), constant(c.inverse_mass)) for c in scene.circles]",
        "an isometry maps circles of other radii",
    ),
    Mutant(
        "velocities_ignored", ISOMETRY,
        "self.circle_of = {(*self.places[i], *self.speeds[i], *self.kinds[i]): i for i in range(self.n)}",
        "self.circle_of = {(*self.places[i], *self.kinds[i]): i for i in range(self.n)}",
        "an isometry maps circles that fly otherwise",
        ((
            ISOMETRY,
            "key = (*self.move(data.places[i]), *self.turn(data.speeds[i]), *data.kinds[i])",
            "key = (*self.move(data.places[i]), *data.kinds[i])",
        ),),
    ),
    Mutant(
        "speeds_not_turned", ISOMETRY,
        "*self.turn(data.speeds[i]), *data.kinds[i])",
        "*data.speeds[i], *data.kinds[i])",
        "an isometry maps places and leaves velocities as they are",
    ),
    Mutant(
        "places_not_compared", LOG,
        "if k is None or b.places.get(k) != place:",
        "if k is None or b.places.get(k, 0) < place:",
        "a block matches one that comes later in its circle's row",
    ),
    Mutant(
        "captures_match", LOG,
        "a.kind != b.kind or a.kind == TAKE or len(a.places) != len(b.places)",
        "a.kind != b.kind or len(a.places) != len(b.places)",
        "a capture matches another, whatever the pocket",
        why_it_survives="a capture ends its circle's row but for reversals, and nothing is asked of a circle "
        "out of play: no question ever reaches such a block",
    ),
    Mutant(
        "walls_to_themselves", ISOMETRY,
        "b = self.wall(link.wall) if is_flat(link) else self.circle(link.b)",
        "b = link.wall if is_flat(link) else self.circle(link.b)",
        "every wall is its own image",
    ),
    Mutant(
        "parallel_walls_alike", ISOMETRY,
        "        return 1, ny / nx, offset / nx, pace / nx\n    return 0, 1, offset / ny, pace / ny",
        "        return 1, ny / nx, nx - nx, pace / nx\n    return 0, 1, nx, pace / ny",
        "parallel walls are one wall",
    ),
    Mutant(
        "lengths_of_rows", LOG,
        "        if len(mine) != len(theirs):\n",
        "        if len(mine) > len(theirs):\n",
        "a circle that has met nothing matches one that has",
    ),
    Mutant(
        "abreast_by_turn", LOG,
        "return self._fixes(IDENTITY, link.a, link.b)",
        "return self._fixes((-IDENTITY[0], IDENTITY[1], IDENTITY[2], -IDENTITY[3]), link.a, link.b)",
        "two that a half turn maps to each other are taken to fly abreast",
    ),
    Mutant(
        "along_by_wrong_mirror", LOG,
        "return self._fixes((xx, xy, xy, yy), i, i)",
        "return self._fixes((-xx, -xy, -xy, -yy), i, i)",
        "who flies at right angles to a wall is taken to fly along it",
    ),
    Mutant(
        "pasts_not_asked", LOG,
        "return all(self.follows(g, i) for i in link.circles)",
        "return all(g.circle(i) is not None for i in link.circles)",
        "meetings are taken for simultaneous by their circles' data at time 0",
    ),
    Mutant(
        "ancestors_not_asked", LOG,
        "if before is None or any(known.get(p.number) is False for p, _ in before):",
        "if before is None:",
        "a block matches although one before it does not",
    ),
    Mutant(
        "among_not_asked", LOG,
        "        if len(a.among) != len(b.among) or images != set(map(self._data.one_of, b.among)):\n",
        "        if len(a.among) != len(b.among):\n",
        "rounds of as many contacts match",
    ),
    Mutant(
        "walls_all_one", ISOMETRY,
        "        if self.alone or is_pair(link) or is_arc(link):\n",
        "        if is_flat(link):\n            return AtWall(link.circle, 0)\n"
        "        if is_pair(link) or is_arc(link):\n",
        "any two walls are one",
    ),
    Mutant(
        "similar_is_enough", ISOMETRY,
        "        if field_sign(square - (wx * wx + wy * wy)) != 0:\n            return\n",
        "",
        "maps that stretch count as isometries",
    ),
    Mutant(
        "held_unproved", HELD,
        "kept = [symmetry for symmetry, isometry in own if self._log.follows(isometry, i)]",
        "kept = [symmetry for symmetry, isometry in own]",
        "a circle is held to a mirror line although its past has left the symmetry",
    ),
    Mutant(
        "held_mean_of_too_few", HELD,
        "tuple(total / (len(kept) + 1) for total in totals)",
        "tuple(total / max(len(kept), 2) for total in totals)",
        "the projection of several symmetries is no mean of a group",
        why_it_survives="two isometries beside the identity make a rotation of their group, and its mean is zero "
        "whatever it is divided by; with one alone the divisor is right",
    ),
    Mutant(
        "held_past_once", HELD,
        "kept = [symmetry for symmetry, isometry in own if self._log.follows(isometry, i)]",
        "kept = [s for s, isometry in own if self._log.follows(isometry, i) or len(self._log.past.rows[i]) > 2]",
        "a circle stays held once it has been for two impulses",
    ),
)  # fmt: skip

FILTERS = (
    Mutant(
        "filter_near", FILTER,
        "near = 4.0 * 64 * UNIT * (self.largest + fastest * latest)",
        f"near = 4.0 * 64 * UNIT * (self.largest + fastest * latest){TOO_SMALL}",
        "the bound on a coordinate is too small by 2**20",
    ),
    Mutant(
        "filter_near_without_time", FILTER,
        "near = 4.0 * 64 * UNIT * (self.largest + fastest * latest)",
        "near = 4.0 * 64 * UNIT * self.largest",
        "the bound on a coordinate forgets the clock",
        why_it_survives="who comes to a circle at a late clock comes from as far as it has flown, so the "
        "largest coordinate holds V T already, up to the slack of the other constants",
    ),
    Mutant(
        "filter_slack", FILTER,
        "slack = 8 * UNIT * fastest",
        f"slack = 8 * UNIT * fastest{TOO_SMALL}",
        "the bound on a velocity is too small by 2**20",
    ),
    Mutant(
        "filter_off_without_slack", FILTER,
        "off = near * wide + 10.0 * slack * (abs(dx) + abs(dy))",
        "off = near * wide",
        "the bound on products forgets the errors of velocities",
    ),
    Mutant(
        "filter_off_without_near", FILTER,
        "off = near * wide + 10.0 * slack * (abs(dx) + abs(dy))",
        "off = 10.0 * slack * (abs(dx) + abs(dy))",
        "the bound on products forgets the errors of places",
    ),
    Mutant(
        "filter_loose", FILTER,
        "loose = 6.0 * slack * wide",
        f"loose = 6.0 * slack * wide{TOO_SMALL}",
        "the bound on the speed squared is too small by 2**20",
        why_it_survives="the error of the products, whose part of velocities is larger, is added wherever this "
        "one is",
    ),
    Mutant(
        "filter_doubt", FILTER,
        "doubt = loose / square + 8 * UNIT",
        f"doubt = (loose / square + 8 * UNIT){TOO_SMALL}",
        "the relative bound on the speed is too small by 2**20",
        why_it_survives="the error of the products, divided by the speed, is larger by the distance over the "
        "reach and is added to the same time",
    ),
    Mutant(
        "filter_off_depth", FILTER,
        "off_depth = (2.0 * passing * off_passing + off_passing * off_passing + 8 * UNIT * reach * reach) / depth",
        "off_depth = 8 * UNIT * reach",
        "the bound on the depth forgets that the passing distance is off",
    ),
    Mutant(
        "filter_off_wait", FILTER,
        "off_wait = (off + off_depth + (ahead + depth) * (doubt + 4 * UNIT)) / speed + abs(wait) * doubt",
        f"off_wait = (off + off_depth + (ahead + depth) * (doubt + 4 * UNIT)) / speed{TOO_SMALL}",
        "the bound on the time to a meeting is too small by 2**20",
    ),
    Mutant(
        "filter_off_time", FILTER,
        "off_time = 2.0 * off_wait + 8 * UNIT * (now + abs(wait))",
        "off_time = 2.0 * off_wait",
        "the bound on a time forgets the rounding of the sum",
        why_it_survives="the error of a coordinate holds V T, so that of the wait holds T already, with a "
        "factor of over 100",
    ),
    Mutant(
        "filter_times_bare", FILTER,
        "found.append((time - off_time, time + off_time, b))",
        "found.append((time, time, b))",
        "a time in doubles is taken as it is",
    ),
    Mutant(
        "filter_receding", FILTER,
        "            if approach > early:\n",
        "            if approach > -early:\n",
        "two that approach by less than the bound are taken to part",
    ),
    Mutant(
        "filter_late_approach", FILTER,
        "early = off + 2.0 * (square + loose) * late",
        "early = off",
        "whether two come nearer is decided at the clock, not at the instant",
        why_it_survives="the clock misses the instant by less than 2**-96 of the time; the bound on products is "
        "over 2**40 times that",
    ),
    Mutant(
        "filter_late_hit", FILTER,
        "if not (wait > off_time + late) or not isfinite(time):\n                unclear.append(b)",
        "if not (wait > off_time) or not isfinite(time):\n                unclear.append(b)",
        "a meeting between the clock and the instant counts",
        why_it_survives="the clock misses the instant by less than 2**-96 of the time; the bound on times is "
        "over 2**40 times that",
    ),
    Mutant(
        "filter_miss", FILTER,
        "if cross > off and (cross - off) * (cross - off) > (square + loose) * (reach * reach) * ROUND_UP:",
        "if cross > off and (cross + off) * (cross + off) > (square + loose) * (reach * reach) * ROUND_UP:",
        "a sign slip: what misses by less than the bound is taken to miss",
    ),
    Mutant(
        "filter_hit", FILTER,
        "if (cross + off) * (cross + off) > room or reach == 0.0:",
        "if (cross - off) * (cross - off) > room or reach == 0.0:",
        "a sign slip: what hits by less than the bound is taken to hit",
    ),
    Mutant(
        "filter_lag", FILTER,
        "            lag = at - bt\n",
        "            lag = bt - at\n",
        "the other circle is carried the wrong way",
    ),
    Mutant(
        "filter_largest_of_last", FILTER,
        "self.largest = max(self.largest, place)",
        "self.largest = place",
        "the largest coordinate is that of the circle seen last",
    ),
    Mutant(
        "filter_fastest_of_last", FILTER,
        "self.fastest = max(self.fastest, speed)",
        "self.fastest = speed",
        "the largest speed is that of the circle seen last",
    ),
    Mutant(
        "filter_apart", FILTER,
        "near = 64 * UNIT * (self.largest + self.fastest * fa[4])",
        f"near = 64 * UNIT * (self.largest + self.fastest * fa[4]){TOO_SMALL}",
        "the bound on a centre's distance from a rim is too small by 2**20",
        ((FILTER, "+ 32 * UNIT * r * r", f"+ 32 * UNIT * r * r{TOO_SMALL}"),),
    ),
    Mutant(
        "filter_apart_near", FILTER,
        "near = 64 * UNIT * (self.largest + self.fastest * fa[4])",
        f"near = 64 * UNIT * (self.largest + self.fastest * fa[4]){TOO_SMALL}",
        "the bound on a centre's place beside a rim is too small by 2**20",
    ),
    Mutant(
        "filter_wall_approach", FILTER,
        "off = norm * flat",
        f"off = norm * flat{TOO_SMALL}",
        "the bound on the approach to a wall is too small by 2**20",
    ),
    Mutant(
        "filter_wall_gap", FILTER,
        "off_gap = 32 * UNIT * size + norm * far",
        f"off_gap = (32 * UNIT * size + norm * far){TOO_SMALL}",
        "the bound on the gap to a wall is too small by 2**20",
    ),
    Mutant(
        "filter_wall_size", FILTER,
        "size = norm * (abs(fx0) + abs(fy0)) + abs(fixed)",
        "size = abs(fixed)",
        "the bound on the gap to a wall forgets how far off the wall's point is",
    ),
    Mutant(
        "filter_wall_time", FILTER,
        "found.append((time - off_time, time + off_time, k))",
        "found.append((time, time, k))",
        "a time at a wall in doubles is taken as it is",
    ),
    Mutant(
        "filter_wall_wait", FILTER,
        "off_wait = (off_gap + wait * off) / -approach + 8 * UNIT * wait",
        "off_wait = 8 * UNIT * wait",
        "the bound on the time to a wall forgets the errors of place and speed",
    ),
    Mutant(
        "bounds_too_tight", BALL,
        "SLACK = 2.0**-50",
        "SLACK = 2.0**-60",
        "doubles around a ball are too tight by 2**10",
        why_it_survives="rounding to doubles keeps the order of two balls, and the bounds of the filter are "
        "wider than what is missing here",
    ),
    Mutant(
        "zero_is_a_sign", BALL,
        "return 0 if value.is_zero() else None",
        "return 0 if value.contains(0) else None",
        "a ball around zero is taken for zero",
    ),
)  # fmt: skip

NUMBERS = (
    Mutant(
        "gap_at_the_clock", "exact/replay/state.py",
        "        if late is None:\n            return pair_gap(",
        "        if True:\n            return pair_gap(",
        "whether two are apart is decided at the clock, not at the instant",
        why_it_survives="the middle of a ball is cut off towards zero, so a clock stands before its instant but for "
        "the radius: two that come nearer are further apart there, and gap zero does not reach the question",
    ),
    Mutant(
        "approach_at_the_clock", "exact/replay/state.py",
        "        if late is None:\n            return pair_approach(",
        "        if True:\n            return pair_approach(",
        "whether two come nearer is decided at the clock, not at the instant",
    ),
    Mutant(
        "late_not_mixed", BALLS,
        "        if self.late is not None:\n            ux, uy",
        "        if False:\n            ux, uy",
        "after a bounce the line goes through the place at the clock, not at the instant",
    ),
    Mutant(
        "late_not_mirrored", BALLS,
        "offset = line.nx * line.x0 + line.ny * line.y0 + body.r * line.length",
        "offset = line.nx * x + line.ny * y",
        "after a wall the line goes through the place at the clock, not at the instant",
    ),
    Mutant(
        "late_not_pushed", "exact/replay/state.py",
        "        if self.late is not None:\n            x, y = x - ux",
        "        if False:\n            x, y = x - ux",
        "after impulses together the lines go through the places at the clock, not at the instant",
    ),
    Mutant(
        "late_not_flipped", "exact/replay/state.py",
        "twice = None if self.late is None else self.late + self.late",
        "twice = None",
        "after a reversal the lines go through the places at the clock, not at the instant",
    ),
    Mutant(
        "left_field_not_replayed", LIVE,
        "            if k in self._left:\n",
        "            if k in self._left and False:\n",
        "at a rise the circles that left the field start from time 0 instead",
    ),
    Mutant(
        "met_kept", BALLS,
        "self.late, self.met, self._told = None, None, None",
        "self.late = None",
        "d of an earlier contact is kept through an instant in the field",
        why_it_survives="what is kept is of a pair that met in balls, and no circle comes back from balls to "
        "the field",
    ),
    Mutant(
        "projected_place_only", LIVE,
        "x, y, vx, vy = cx + a * x + b * y, cy + c * x + d * y, a * vx + b * vy, c * vx + d * vy",
        "x, y, vx, vy = cx + a * x + b * y, cy + c * x + d * y, a * vx, d * vy",
        "a held circle's velocity is projected on an axis",
    ),
    Mutant(
        "field_after_all", LIVE,
        "in_field = self._in_play > 0 and self.all_exact(taking_part) and self._try_field(step, taking_part)",
        "in_field = self.field is not None and self._try_field(step, taking_part)",
        "a step is done in the field although a circle has left it",
    ),
)  # fmt: skip

TOLD = (
    Mutant(
        "wall_from_the_instant", "exact/replay/wall_flights.py",
        "return flight.t, wall_hit_time(self._wall_gap(link, flight.x, flight.y), self.wall_approach(link))",
        "return flight.t, wall_hit_time(self.wall_gap(link), self.wall_approach(link))",
        "the time to a wall is reckoned from the instant, and added to the clock",
    ),
    Mutant(
        "state_before_the_instant", MOTION,
        "bisect_right(knots, own, key=_instant)",
        "bisect_right(knots, own - 1, key=_instant)",
        "the state at a time of the run is the one before that instant",
    ),
    Mutant(
        "at_in_doubles", MOTION,
        "while k > 0 and not rough[k] < near - room and self._after(self.knot_time(i, k), time):",
        "while k > 0 and rough[k] > near:",
        "at() tells before from after in doubles",
    ),
    Mutant(
        "at_by_clock", MOTION,
        "near = t if not isinstance(t, arb) else self.log.events.time_at(instant) if self.log.events else arb.nan()",
        "near = t",
        "at() takes a knot's clock for its instant",
    ),
    Mutant(
        "at_without_room", MOTION,
        "room = abs(near) * 2.0**-50",
        "room = 0.0",
        "at() finds a knot by doubles without room for their rounding",
        why_it_survives="rounding to doubles keeps the order of a knot and a time, but where the rounding "
        "itself is in doubt",
    ),
    Mutant(
        "at_steps_of_the_knot", MOTION,
        "bodies, upto = (i, *time.bodies), max(upto, time.upto)",
        "bodies = (i, *time.bodies)",
        "the state at a time of the run is reckoned before the steps that tell the time",
    ),
    Mutant(
        "home_not_turned", MOTION,
        "_known(log, -c.vx), _known(log, -c.vy)",
        "_known(log, c.vx), _known(log, c.vy)",
        "the state at home has the velocities of time 0",
    ),
    Mutant(
        "half_an_instant", HISTORY,
        "while len(row) > 1 and row[-1][-1] > number:",
        "while len(row) > 1 and row[-1][-1] >= number:",
        "where a run gives up, the knots of its last whole instant are dropped",
    ),
    Mutant(
        "steps_not_dropped", HISTORY,
        "        del self.steps[step:]\n",
        "",
        "where a run gives up, the steps of the instant that it has begun stay in the log",
        why_it_survives="every number says how many steps of the log it needs; nothing reads the log to its end",
    ),
    Mutant(
        "entry_time_of_clock", INSTANT,
        "                note.last = Mark(done.number, decider.reading.entry_time(link), step, link)\n",
        "                note.last = Mark(done.number, decider.reading.now(bodies[i]), step, i)\n",
        "an entry without capture is given the time of the circle's last contact",
    ),
    Mutant(
        "doubt_is_a_tie", PLAIN,
        "sign = self._ask(Sooner(Moment(first.link, first.graze), Moment(second.link, second.graze)))",
        "sign = 0",
        "the interval engine takes a doubt for a tie",
    ),
    Mutant(
        "interval_lower_bounds", PLAIN,
        "return (first.time < second.time) is True",
        "return self._bounds(first.time)[0] < self._bounds(second.time)[0]",
        "the interval engine compares times by their lower bounds",
    ),
    Mutant(
        "interval_grazes_dropped", PLAIN,
        "        if disc < 0:\n            return None\n",
        "        if disc <= 0:\n            return None\n",
        "the interval engine takes a graze for a miss",
    ),
)  # fmt: skip

FRESH: tuple[Mutant, ...] = (
    *CONTACTS, *GATHERING, *ENTRIES, *REVERSAL, *SYMMETRY, *FILTERS, *NUMBERS, *TOLD,
)  # fmt: skip
