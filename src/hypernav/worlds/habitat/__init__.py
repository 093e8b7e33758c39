"""habitat-sim as a world: its images and its path finder, for those who have it."""
