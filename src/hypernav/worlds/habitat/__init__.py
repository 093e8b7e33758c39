"""habitat-sim as a world, if it is installed: its images and its path finder."""
