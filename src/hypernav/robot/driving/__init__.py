"""A robot that is driven by velocities, and stops for what its camera sees in its way."""
