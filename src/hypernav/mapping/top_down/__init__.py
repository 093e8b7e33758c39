"""The map of free and occupied cells, drawn from depth images frame by frame."""
