"""What documents are made of: numbers of any engine, exact text with shared definitions, objects, tables."""
