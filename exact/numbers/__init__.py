"""The number systems of the exact engine, one a file: rational and root fields, balls, residues."""
