"""The numbers of a document: bounds and doubles of any engine, exact text with shared definitions."""
