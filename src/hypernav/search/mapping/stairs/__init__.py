"""Stairs and ramps: how they are seen, and how a robot goes over them to other floors."""
