"""Grids: scenes, engines and settings, a row for each, in one store; sweeps, suites and others plan them."""
