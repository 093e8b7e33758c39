"""A robot driven by velocities, which stops for obstacles that its camera sees."""
