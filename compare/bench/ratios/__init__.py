"""The figures: each is a ratio of two things timed in one run."""
