"""The phases of a search: look around, explore, approach, verify, look from another side, end."""
