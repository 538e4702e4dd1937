"""What is shown of runs and comparisons: on the terminal, in HTML, in pictures."""
