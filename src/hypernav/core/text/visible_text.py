"""Makes control characters in text from outside visible.

A server's error, a goal or a path may hold characters that a terminal or a browser executes
instead of showing them: escape sequences, their one-character forms (C1), overrides of the reading
direction. Texts are stored unchanged and made visible where they are shown: on the terminal by
`hypernav.cli.screen.terminal`, on pages by `hypernav.show.templating`.
"""

import re

_OBEYED = re.compile(
    "[\x00-\x09\x0b-\x1f\x7f-\x9f"  # controls except the line feed
    "\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069"  # direction, and other line ends
    "\ud800-\udfff]"  # half of a surrogate pair, which cannot be encoded
)


def visible(text: str) -> str:
    r"""The text with a Python escape such as ``\x1b`` for each control character."""
    if text.isprintable():
        return text
    return _OBEYED.sub(lambda match: match[0].encode("unicode_escape").decode("ascii"), text)
