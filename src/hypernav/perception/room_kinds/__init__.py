"""The table of what stands in which kind of room."""
