"""Building blocks of 3D models: meshes, solids, surfaces of revolution, joinery."""
