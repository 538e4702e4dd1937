"""Tests of the audit, and the bench by which it is judged."""
