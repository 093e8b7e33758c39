"""Value maps: how well what the camera saw of each place fits the goal."""
