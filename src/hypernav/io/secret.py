"""Blanks a key in what a server says: a proxy's error may repeat the request's headers."""

import re
from html import escape

_SHORTEST = 8
"""Length of a key below which it is a placeholder, such as "none", that may be in any text."""
_MASK = "***"


class Secret:
    """A key that must not show in texts, however its characters are escaped there."""

    def __init__(self, key: str) -> None:
        """Remember how the key may be spelled.

        Args:
            key: The key; one of fewer than eight characters is not blanked.
        """
        # Backslashes before it go, too: JSON would have an escape in the middle of nothing.
        spelled = r"\\*" + "".join(map(_spellings, key)) if len(key) >= _SHORTEST else ""
        self._text = re.compile(spelled) if spelled else None
        self._bytes = re.compile(spelled.encode()) if spelled else None

    def blanked(self, text: str) -> str:
        """The text without the key."""
        return self._text.sub(_MASK, text) if self._text else text

    def blanked_bytes(self, text: bytes) -> bytes:
        """The UTF-8 text without the key; JSON stays JSON."""
        return self._bytes.sub(_MASK.encode(), text) if self._bytes else text


def _spellings(character: str) -> str:
    """A pattern of a character as it is, or escaped as in JSON, URLs or HTML, even repeatedly."""
    code, plain = f"{ord(character):02x}", re.escape(character)
    longest_first = (
        rf"\\+u(?i:{code:0>4})",
        rf"\\+{plain}" if not character.isalnum() else "",
        rf"%(?:25)*(?i:{code})",
        rf"&(?:amp;)*#(?:{ord(character)}|[xX]0*(?i:{code}));",
        re.escape(escape(character)),
        plain,
    )
    return f"(?:{'|'.join(filter(None, longest_first))})"
