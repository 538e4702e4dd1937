"""Fuzz harness of the exact engine: an independent referee, scenes full of coincidences, and what must agree."""
