"""The event-driven simulation, for any number system: predict, gather an instant, resolve it, repeat."""
