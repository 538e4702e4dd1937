"""The formulas of the laws as the flat loop runs them: written by hand, and inlined by a program."""
