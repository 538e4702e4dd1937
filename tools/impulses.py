"""What an instant does: rounds of impulses by the scene's tie policy, then entries into pockets."""

from .arithmetic import Refuted, Undecided
from .laws import place
from .witnesses import Block, Witnesses


class Impulses(Witnesses):
    """Carries out instants on `flights`. Attributes: `coming`, what is known of the next meeting of two; `lasting`, the
    contacts that stay at gap zero; `gone`, the captured circles."""

    def fly(self, i):
        return self.flights[i]

    def sign(self, question, c, value):
        """The sign of a number: its interval's, or zero by a witness."""
        sign = value.sign()
        return sign if sign is not None else 0 if self.zero(question, c) else None

    def resolve(self, known, entry, default, near=(), everyone=False):
        """All that an instant does with what stands at gap zero at it, `known` with the sign of its closing speed: the
        rounds of everything that hangs together with what approaches, then entries; then the next meetings."""
        rounds, moved = iter(entry.get("rounds", default)), set(range(self.n)) if everyone else set()
        groups = self.hanging([c for c in known if c[1] >= 0], range(self.n))
        struck = sorted(
            (min(c for c in g if known[c] < 0), sorted(g)) for _, g in groups if any(known[c] < 0 for c in g)
        )
        for first, group in struck:
            bodies = {i for c in group for i in c if i < self.n}
            if any(c[1] >= 0 and bodies & set(c) for c in near):
                raise Undecided(f"a graze may take part in the impulses of {first}")
            moved |= self.settle(first, group, bodies, known, rounds)
        if next(rounds, None) is not None:
            raise Refuted("it has rounds of impulses where nothing approaches")
        self.count += bool(struck)
        self.standing[self.age] = frozenset(c for c in known if c[1] >= 0)
        self.enter(known, moved, entry)
        for c in known:
            if c[1] >= 0 and not (c in self.lasting and not moved.intersection(c)):
                self.lasting.discard(c)
                if known[c] == 0 and not self.gone.intersection(c) and self.lasts(c):
                    self.lasting.add(c)
            self.coming[c] = None
        for c in self.meets:
            if (c[0] in moved or c[1] in moved) and c not in known:
                self.coming[c] = self.foreseen(c)
        self.known_now = known

    def hanging(self, contacts, through):
        """Contacts in groups that share circles, directly or through others, and those circles."""
        groups = []
        for c in contacts:
            bodies, mine, apart = {i for i in c if i in through}, [c], []
            for others, theirs in groups:
                if others & bodies:
                    bodies, mine = bodies | others, mine + theirs
                else:
                    apart.append((others, theirs))
            groups = [*apart, (bodies, mine)]
        return groups

    def settle(self, first, group, bodies, known, rounds):
        """Rounds of impulses until nothing of a group approaches; the circles that moved."""
        source, moved = self.source, set()
        if 0 < self.age == self.age & -2:  # not at time 0, not after the reversal: the group's own first arrival tells
            source = first, {i: len(self.rows[i]) for i in first if i < self.n}
        for i in bodies:
            self.flights[i] = self.put(self.flights[i], self.time, self.age)
        while coming := sorted(c for c in group if known[c] < 0):
            push = [tuple(c) for c in next(rounds, ())]
            if self.policy == "simultaneous":
                new, among = self.together(push, coming), coming
            else:
                chosen = coming[self.draw.randrange(len(coming)) if self.draw and len(coming) > 1 else 0]
                if push != [chosen]:
                    raise Refuted(f"it is {chosen} that the order says, not {push}")
                new, among = self.balls.blow(self.fly, push)[2], push
            for circles, mine in self.hanging(among, self.movable):
                places = {i: len(self.rows[i]) for i in circles}
                self.log(Block("kick", mine, [c for c in push if c in mine], places, source, self.age))
            hit = {i for c in push for i in c} & self.movable
            for i in hit:
                self.flights[i] = (*self.flights[i][:2], *new[i], *self.flights[i][4:])
            moved |= hit
            for c in group:
                if hit.intersection(c):
                    known[c] = self.sign("still", c, self.balls.meeting(self.fly, c)[2])
        return moved

    def together(self, push, coming):
        """The velocities after a round in which all that approach get their impulses together."""
        self.push = push
        if not push or len(set(push)) < len(push) or not set(push) <= set(coming):
            raise Refuted(f"{push} push, but {coming} approach")
        impulses, slacks, new = self.balls.blow(self.fly, push, [c for c in coming if c not in push])
        for c, s in impulses.items():
            if s.sign() != 1:
                raise (Undecided if s.sign() is None else Refuted)(f"{c} do not push")
        for c, slack in slacks.items():
            if self.sign("slack", c, slack) < 0:
                raise Refuted(f"{c} push too")
        return new

    def log(self, block):
        for i in block.places:
            self.rows[i].append(block)
        if self.turned and block.kind == "kick":
            self.undo(block)

    def lasts(self, c):
        """Whether two at gap zero that neither approach nor part stay there."""
        if c[1] >= self.n:
            return True
        sign = self.balls.meeting(self.fly, c)[4].sign()
        return sign == 0 or (sign is None and self.zero("together", c))

    def enter(self, known, moved, entry):
        """Centres that stand on a rim and move inward, in the state after the impulses; captures."""
        found, places = [], range(len(self.data["pockets"]))
        for c in [(i, -1 - k) for i in sorted(self.movable - self.gone) for k in places]:
            if c[0] in moved:
                _, gap, closing, _, _ = self.balls.meeting(self.fly, c)
                if c not in known and gap.sign() in (1, -1):
                    continue
                sign = self.sign("still", c, closing)
                if sign < 0 and c not in known and gap.sign() is None:
                    self.zero("rim", c)
                known[c] = sign
            if known.get(c, 0) < 0:
                found.append(c)
        if sorted(found) != sorted((i, -1 - k) for i, k in entry.get("entries", ())):
            raise Refuted(f"{found} enter")
        for i in {i for i, _ in found} if self.scene.get("capture") else ():
            self.flights[i] = (
                *place(self.flights[i], self.time),
                self.balls.zero,
                self.balls.zero,
                self.time,
                self.age,
            )
            self.log(Block("take", (), (), {i: len(self.rows[i])}, self.source, self.age))
            self.gone.add(i)
            moved.add(i)
            for c in [c for c in known if i in c]:
                del known[c]
            self.lasting = {c for c in self.lasting if i not in c}
