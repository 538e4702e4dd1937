"""This project's own package of that name."""

WHOSE = "the sample's"
