"""A* on the costmap, path following, and the navigator that puts them together."""
