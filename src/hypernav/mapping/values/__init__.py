"""Value maps: how well what was seen where fits the goal."""
