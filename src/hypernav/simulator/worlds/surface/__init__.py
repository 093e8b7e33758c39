"""The walkable surface: where a robot can stand, geodesics, view points and starts."""
