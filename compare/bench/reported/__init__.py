"""What a benchmark measured: as JSON and back, for people, and against another run."""
