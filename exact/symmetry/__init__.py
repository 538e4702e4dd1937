"""Isometries of scenes and of logged pasts: what they prove zero or alike, and what they hold in place."""
