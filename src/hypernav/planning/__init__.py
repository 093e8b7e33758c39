"""A* on the inflated map and the waypoint follower."""
