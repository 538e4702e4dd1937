"""Does floating point change statistics? Ensembles in few bits against certified ones."""
