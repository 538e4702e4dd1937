"""What may stop an engine that follows the reference: each cause a module, with one function that tries it."""
