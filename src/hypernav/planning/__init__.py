"""A* on the inflated map, steering, and the navigator that puts them together."""
