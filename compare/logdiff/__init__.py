"""Two runs of any engine, in any world, compared by their logs."""
