"""The laws of motion and collision: derived by SymPy, in stable form, and proved equal."""
