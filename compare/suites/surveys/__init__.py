"""What the survey keeps: its rows in a file, the advice beside them, its page."""
