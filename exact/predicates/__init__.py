"""What a run must know of its numbers: questions, each a sign, and the filter that foresees most of them in doubles."""
