"""What decides for the exact engine: predictions through a filter, and a cascade of proofs."""
