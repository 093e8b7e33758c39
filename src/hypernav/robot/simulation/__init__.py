"""A simulated robot that searches over the network; the only part of `robot` that uses a world."""
