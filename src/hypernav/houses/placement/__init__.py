"""Placement of models in a room: poses, collisions, free floor, visibility."""
