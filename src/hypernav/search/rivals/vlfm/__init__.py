"""VLFM: the frontier around which the views fit the goal best."""
