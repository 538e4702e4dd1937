"""What costs nothing before it is asked for: names, dataclasses, sequences, the version."""
