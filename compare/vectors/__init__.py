"""Vectors for the authors of engines: single first meetings, each with its certified answer."""
