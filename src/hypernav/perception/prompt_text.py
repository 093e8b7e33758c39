"""Configured texts of questions: check of their placeholders, and a hash for the results."""

import hashlib
from string import Formatter


def check_placeholders(prompt: str, *names: str) -> str:
    """The text of a question, unchanged, if it can be filled in.

    Args:
        prompt: Text with names in braces.
        names: Names that may stand in braces.

    Raises:
        ValueError: It holds other names, formats or single braces.
    """
    try:
        if any(spec or conversion for _, _, spec, conversion in Formatter().parse(prompt)):
            raise ValueError("formats")  # a width could fill the memory
        prompt.format(**dict.fromkeys(names, ""))
    except (AttributeError, KeyError, IndexError, ValueError) as error:
        *others, last = (f"{{{name}}}" for name in names)
        allowed = f"{', '.join(others)} and {last}" if others else last
        raise ValueError(f"may hold {allowed}; other braces are doubled: {{{{ }}}}") from error
    return prompt


def prompt_hash(prompt: str) -> str:
    """The first 12 hexadecimal digits of the text's SHA-256, which tell versions apart."""
    return hashlib.sha256(prompt.encode()).hexdigest()[:12]
