"""The article's engine, in SymPy alone: an oracle that shares no decision with the exact engine."""
