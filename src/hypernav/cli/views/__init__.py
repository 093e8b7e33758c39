"""The views of a search that a command opens beside its page and video."""
