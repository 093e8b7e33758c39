"""Where a robot begins on its memory: told and checked, or found by what it sees."""
