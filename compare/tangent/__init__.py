"""The tangent map of a run: its impacts one by one, and how displacements grow along them."""
