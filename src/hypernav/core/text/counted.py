"""Counts with their nouns."""


def number_of(count: int, noun: str, plural: str = "") -> str:
    """A number with its noun, for example "1 episode" and "2 episodes"."""
    return f"{count:,} {noun if count == 1 else plural or f'{noun}s'}"
