"""What the size and form of a thing say for and against a name."""
