"""Checkers for agents and worlds of your own: what the contract says, and what breaks it."""
