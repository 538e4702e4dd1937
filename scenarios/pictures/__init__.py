"""Pictures of scenes and states, and what a notebook shows of them."""
