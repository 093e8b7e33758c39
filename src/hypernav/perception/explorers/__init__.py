"""Global perception: where to go next while the goal is out of sight."""
