"""The smallest scene on which an engine still leaves the true history."""
