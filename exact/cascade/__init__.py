"""How a question is answered: rungs from the cheapest up, each certain or silent."""
