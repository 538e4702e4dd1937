"""How errors grow along one run: exponents with intervals, and how many digits are right at its end."""
