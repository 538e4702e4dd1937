"""What may part two histories: each cause a module, with one function that tries it."""
