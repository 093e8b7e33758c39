"""Outlines of regions, and the convex polygons within them."""
