"""What a run must know of its numbers, and how it comes to know it: filters, balls, fields, proofs of zero."""
