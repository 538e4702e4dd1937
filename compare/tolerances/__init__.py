"""What errors allowed by the rounding model may have grown to, and how far a history can be required."""
