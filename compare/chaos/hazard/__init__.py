"""How large an engine's errors are at each decision of a run, beside how much that decision leaves."""
