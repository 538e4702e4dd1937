"""Ensembles: one comparison for each scene of a family, kept in a file, and what the family says."""
