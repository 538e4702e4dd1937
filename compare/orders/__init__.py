"""The orders in which contacts of one instant can be resolved one by one: all of them, or the one of a history."""
