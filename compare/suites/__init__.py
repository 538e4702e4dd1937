"""Many scenes and many engines at once: suites from a file, what changed since an earlier one, and the survey."""
