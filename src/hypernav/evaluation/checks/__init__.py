"""Checkers of the contracts of agents and worlds, for your own implementations."""
