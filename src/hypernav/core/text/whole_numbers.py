"""Whole numbers and ranges of them in options."""

_MOST_DIGITS = 9


def is_whole_number(text: str) -> bool:
    """Whether a text is a whole number, 0 or more, of at most nine digits."""
    return text.isascii() and text.isdecimal() and len(text) <= _MOST_DIGITS
