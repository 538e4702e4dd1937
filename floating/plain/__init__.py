"""The event loop in numbers that answer at once: what every engine without certainty shares."""
