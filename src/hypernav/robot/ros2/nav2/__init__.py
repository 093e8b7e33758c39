"""A robot driven by Nav2: goals are sent, and odometry shows whether they are reached."""
