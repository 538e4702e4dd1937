"""One instant: all that falls on it is gathered, then resolved in rounds."""
