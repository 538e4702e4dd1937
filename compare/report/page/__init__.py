"""The parts of the HTML report: each section's facts, the template, its style, and what moves in it."""
