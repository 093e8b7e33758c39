"""VLFM: exploration by a value map; what the camera sees is scored, and frontiers by the scores."""
