"""Kinds of scenes that are hard to run, a family a file: one function a kind."""
