"""One family of ever harder scenes a file; the table beside this folder lists them."""
