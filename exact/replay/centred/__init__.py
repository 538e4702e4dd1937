"""Exact midpoints, and one set of all their deviations: what long runs are carried out on."""
