"""Shadowing: is what an engine computed the true history of a start nearby?"""
