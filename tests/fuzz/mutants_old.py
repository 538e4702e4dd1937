"""Faults that the engine once had, planted again as far as its present form admits them."""

from __future__ import annotations

from fuzz.mutant import Mutant

LOOP, INSTANT = "exact/simulation/loop.py", "exact/simulation/instant.py"
GATHERING = "exact/simulation/instant.py"

OLD: tuple[Mutant, ...] = (
    Mutant(
        "w01_entry_ahead",
        GATHERING,
        "        front: list[Arrival[N]] = []\n",
        """        entry = next((a for a in timed if not a.link.pushes), None)
        if entry is not None and not any(a.link.pushes and entry.link[0] in a.link for a in timed):
            for rival in timed:
                if rival is not entry:
                    self.queue.put_back(rival)
            return [entry], []
        front = []
""",
        "an entry is chosen ahead of other circles' contacts, and the limit is held against it alone",
    ),
    Mutant(
        "w02_entries_not_ordered",
        GATHERING,
        "decision = meetings.order(rival, first)",
        """decision = meetings.order(rival, first)
            if not (rival.link.pushes or first.link.pushes):
                decision = decision._replace(sign=1)""",
        "two entries are never compared",
    ),
    Mutant(
        "w03_home_despite_capture",
        "exact/log_symmetry.py",
        "self.levels = [block.places.get(i, level) for i, level in enumerate(self.levels)]",
        """for i, place in block.places.items():
                    self.levels[i] = sum(not b.kind for b in self.past.rows[i][:place])""",
        "only impulses count as ways to be undone: home is told although a circle was captured",
    ),
    Mutant(
        "w04_entry_beside_contact",
        GATHERING,
        """            if decision.sign > 0:
                self.queue.put_back(rival)
            elif decision.sign == 0:
                if rival.link.pushes:""",
        """            if decision.sign > 0 and rival.link.pushes:
                self.queue.put_back(rival)
            elif decision.sign >= 0:
                if rival.link.pushes:""",
        "an entry a flaw after a contact is taken along with it, before the reversal that comes between",
    ),
    Mutant(
        "w05_pocket_for_wall",
        "exact/isometry.py",
        "return None if k is None else Entry(a, k)",
        "return AtWall(a, 0) if k is None else Entry(a, k)",
        "the image of a pocket that has none is taken for wall 0",
    ),
    Mutant(
        "w06_doubtful_entry_taken",
        GATHERING,
        """                if settled is not None:
                    self.queue.put_back(settled)
""",
        """                if settled is not None:
                    self.queue.put_back(settled)
            settled = [a for a in self.queue._heap if a.link in {r.link for r in rivals if r.time is None}]
            entries = [a for a in settled if not a.link.pushes and a.time is not None and self.queue.fresh(a)]
            if entries:
                self.queue._heap.remove(entries[0])
                __import__("heapq").heapify(self.queue._heap)
                return entries[:1]
""",
        "a doubtful entry is settled and taken, although its time lies beyond others in the queue",
    ),
    Mutant(
        "w07_lasting_not_reached",
        "exact/simulation/policies.py",
        "pending = set(links) | set(touching.all())",
        "pending = set(links)",
        "the lasting contacts of a circle that is hit take no part",
    ),
    Mutant(
        "w08_touches_join_late",
        "exact/simulation/policies.py",
        "        coming = [link for link in links if told[link] < 0]\n",
        """        coming = [link for link in links if told[link] < 0]
        coming = [link for link in coming if known.get(link) != 0] or coming
""",
        "grazes and lasting contacts act only once the hits of the instant are done",
    ),
    Mutant(
        "w09_end_before_the_last",
        "exact/exact_engine.py",
        "return time_of_return(log, mark, last)",
        "return time_of_return(log, mark, mark.number)",
        "the final state of a run to the return is the one before what happens at that very time",
    ),
    Mutant(
        "w10_grazes_left_out",
        INSTANT,
        "found = components([*hits, *touches], self.touching)",
        "found = components([*hits], self.touching)",
        "contacts that stand at gap zero at an instant are no part of its rounds",
    ),
    Mutant(
        "w11_tied_entry_lost",
        GATHERING,
        "                chosen.append(rival)\n",
        """                if rival.link.pushes or first.link.pushes:
                    chosen.append(rival)
""",
        "of two entries at one instant the second is lost",
    ),
    Mutant(
        "w11_tied_entries_lost",
        GATHERING,
        "                chosen.append(rival)\n",
        """                chosen.append(rival)
                if not (rival.link.pushes or first.link.pushes):
                    chosen, ties = [], []
                    break
""",
        "two entries at one instant are both lost",
    ),
)  # fmt: skip
