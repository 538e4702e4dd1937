"""The game engine Pymunk, asked for its contacts: the one independent witness of the physics."""
