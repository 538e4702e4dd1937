"""What the adapters share: the package and its version, the loop in steps, walls, collisions of several steps."""
