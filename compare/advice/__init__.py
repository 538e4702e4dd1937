"""Advice: the cheapest setting of an engine that gets what is asked for right, proved by the certified run."""
