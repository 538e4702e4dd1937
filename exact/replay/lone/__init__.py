"""Contacts that stand alone: the flight and the impulse in one go, on balls or on midpoints."""
