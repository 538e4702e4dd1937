"""Adapters of engines that people use, one a file; each needs the extra of its name, such as `truebreak[box2d]`."""
