"""A simulated robot that searches over the network; no other part of the robot knows a world."""
