"""Is a number a square? Its root, by descent, or the proof that it has none."""
