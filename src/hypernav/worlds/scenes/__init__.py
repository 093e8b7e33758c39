"""Reading of scenes: triangles, materials and named instances."""
