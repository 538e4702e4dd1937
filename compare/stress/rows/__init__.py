"""One place of a stress map in every engine: its row, the marks in it, and what tells who is right."""
