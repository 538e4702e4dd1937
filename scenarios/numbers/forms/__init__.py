"""Forms of a number: expressions of rationals and roots, SymPy's, and those of number types of one's own."""
