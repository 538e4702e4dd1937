"""The decision at which two histories part, and how a run has it."""
