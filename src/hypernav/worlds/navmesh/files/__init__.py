"""Navigation mesh files of habitat-sim, read and written."""
