"""What a history comes to, and which outcomes the physics permits."""
