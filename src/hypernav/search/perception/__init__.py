"""Local perception of the goal, and explorers for where to look next."""
