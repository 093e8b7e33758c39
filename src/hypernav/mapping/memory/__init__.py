"""What a robot knows of a building: floors, things, and what may be the goal."""
