"""What an exact run gives back: its numbers, its motion, and how they are written."""
