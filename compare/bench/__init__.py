"""Figures of speed, each beside something timed in the same run."""
