"""An event log, and the state that it computes in any number system."""
