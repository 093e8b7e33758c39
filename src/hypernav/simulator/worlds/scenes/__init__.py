"""Reads scenes: triangles, materials and named instances."""
