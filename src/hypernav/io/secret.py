"""Blanks a key in what a server says: a proxy's error may repeat the request's headers."""

import re
from html import escape

_SHORTEST = 8
"""Length of a key below which it is a placeholder, such as "none", that may be in any text."""
_MASK = b"***"
_KEPT = "surrogatepass"


class Secret:
    """A key that must not show in texts, however its characters are escaped there."""

    def __init__(self, key: str) -> None:
        """Remember how the key may be spelled.

        Args:
            key: The key; one of fewer than eight characters is not blanked.
        """
        one_slash = re.sub(r"\\+", r"\\", key)  # escaped, nobody knows how many they were
        spelled = "".join(map(_spellings, one_slash)) if len(key) >= _SHORTEST else ""
        self._spelled = re.compile(spelled.encode()) if spelled else None

    def blanked(self, text: str) -> str:
        """The text without the key."""
        return self.blanked_bytes(text.encode(errors=_KEPT)).decode(errors=_KEPT)

    def blanked_bytes(self, text: bytes) -> bytes:
        """The UTF-8 text without the key; JSON stays JSON."""
        if self._spelled is None:
            return text
        parts, end = list[bytes](), 0
        for found in self._spelled.finditer(text):
            # Backslashes before it go, too: JSON would have an escape in the middle of nothing.
            parts += [text[end : found.start()].rstrip(b"\\"), _MASK]
            end = found.end()
        return b"".join([*parts, text[end:]])


def _spellings(character: str) -> str:
    """A pattern of a character as it is, or escaped as in JSON, URLs or HTML, up to four times.

    Repetitions are bounded and nothing is tried twice: of a server that sends backslashes alone, or
    the beginning of the key again and again, the search would take hours.
    """
    code = f"{ord(character):02x}"
    plain = r"\\{1,16}" if character == "\\" else re.escape(character)
    longest_first = (
        rf"\\{{1,8}}u(?i:{code:0>4})",
        rf"\\{{1,8}}{plain}" if not character.isalnum() else "",
        rf"%(?:25){{0,3}}(?i:{code})",
        rf"&(?:amp;){{0,3}}#(?:{ord(character)}|[xX]0{{0,6}}(?i:{code}));",
        re.escape(escape(character)) if escape(character) != character else "",
        plain,
    )
    return f"(?>{'|'.join(filter(None, longest_first))})"
