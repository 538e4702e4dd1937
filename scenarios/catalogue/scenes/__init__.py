"""The scenes of the catalogue, one family a file."""
