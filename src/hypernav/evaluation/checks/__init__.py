"""Checkers for agents and worlds of your own: what the contract says, and what breaks it."""

from hypernav.evaluation.checks.agents import check_agent
from hypernav.evaluation.checks.worlds import check_world

__all__ = ["check_agent", "check_world"]
