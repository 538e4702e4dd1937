"""What is printed as JSON, and its schemas."""
