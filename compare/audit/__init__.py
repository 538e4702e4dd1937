"""The audit: every step of a run is checked against the laws, on the engine's own numbers."""
