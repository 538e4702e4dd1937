"""Runs of any engine, made of what it reports."""
