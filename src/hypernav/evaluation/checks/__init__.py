"""Checkers of the contracts of agents and worlds, for those of your own."""
