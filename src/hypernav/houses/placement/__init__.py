"""The poses that models can take in a room, and the floor that they leave free."""
