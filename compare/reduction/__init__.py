"""The smallest scene on which an engine still diverges from the true history."""
