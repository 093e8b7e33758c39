"""Triangles of each polygon that follow the voxels' heights."""
