"""Models of what stands in offices."""
