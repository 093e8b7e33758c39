"""Where things stand in the rooms."""
