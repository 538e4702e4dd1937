"""Exact real numbers: rationals and nested square roots, read from text, decided against zero."""
