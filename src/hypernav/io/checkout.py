"""The commit of this program."""

import subprocess
from functools import cache
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parents[1]
_PATIENCE_S = 10.0


@cache
def commit() -> str:
    """The commit of the checkout that this program runs from, followed by + if files differ.

    Returns:
        The first letters of its name; empty for an installed package, or without git. An
        environment inside the checkout of another project doesn't count as that project's.
    """
    root = _PACKAGE.parents[1]
    if root / "src" / "hypernav" != _PACKAGE or not (root / ".git").exists():
        return ""
    asked = ["git", "-C", str(root), "describe", "--always", "--dirty=+", "--exclude=*"]
    try:
        done = subprocess.run(asked, capture_output=True, text=True, timeout=_PATIENCE_S)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return done.stdout.strip() if done.returncode == 0 else ""
