"""Global perception: the choice of destinations while the goal is out of sight."""
