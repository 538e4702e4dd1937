"""Chaos along one certified run: growth of errors, Lyapunov exponents, and how long engines can be trusted."""
