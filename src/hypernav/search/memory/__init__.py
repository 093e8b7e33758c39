"""What a robot knows of a building: floors, things seen, and candidates for the goal."""
