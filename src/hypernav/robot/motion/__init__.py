"""Velocities for robots that drive smoothly: pure pursuit along the path of an agent."""
