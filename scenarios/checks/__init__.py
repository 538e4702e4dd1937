"""Checks of scenes and of what is given for them, and how an error shows a bad value."""
