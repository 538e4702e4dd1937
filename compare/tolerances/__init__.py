"""What honest errors may have grown to, and how far a history can be required."""
