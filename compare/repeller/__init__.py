"""The pinball of three fixed discs: its periodic orbits, proved; escape, exponent and entropy from them."""
