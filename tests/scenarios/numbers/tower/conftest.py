"""The tests of this room, and of the rooms in it, import `towers` from here."""
