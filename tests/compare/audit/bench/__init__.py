"""Engines, bugs and scenes by which the audit of engines is judged; nothing here shares code with what it judges."""
