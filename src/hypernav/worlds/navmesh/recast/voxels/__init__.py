"""Triangles as voxels, and the open space above those that a robot can stand on."""
