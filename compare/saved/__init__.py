"""Runs and comparisons that are kept: in files, in the cache, and taken up again."""
