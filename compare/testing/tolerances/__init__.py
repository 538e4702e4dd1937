"""What a check holds an engine to: the reach of honest arithmetic, errors as they grow, and what holds beyond."""
