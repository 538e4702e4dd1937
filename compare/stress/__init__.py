"""Families of scenes that get harder, and where on them each engine's answer turns wrong."""
