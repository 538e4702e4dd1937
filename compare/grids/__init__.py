"""Grids: scenes, engines and settings, a row for each, in one store; sweep, suite, survey, stress and others plan them."""
