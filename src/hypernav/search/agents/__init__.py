"""Agents that find a goal; none of them knows a simulator."""
