"""What is written on the command line: options, numbers, examples, and how a shell completes them."""
