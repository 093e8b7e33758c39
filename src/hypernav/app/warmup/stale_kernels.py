"""Compiled kernels that are older than the source of one of them.

Numba looks at the file of a kernel alone: one that calls a function of another file would stay what
it was when that file changes, as on a pull into a checkout.
"""

from pathlib import Path

_PACKAGE = Path(__file__).parents[2]
_SOURCES = ("*_kernels.py", "core/geometry/depth.py")


def forget_stale_kernels(package: Path = _PACKAGE) -> None:
    """Forget what was compiled before the latest change of any kernel's source.

    Args:
        package: Folder of the package. Kernels that Numba keeps elsewhere stay.
    """
    changed = max(
        (source.stat().st_mtime for pattern in _SOURCES for source in package.rglob(pattern)),
        default=0.0,
    )
    for index in package.rglob("__pycache__/*.nbi"):
        if index.stat().st_mtime < changed:
            index.unlink(missing_ok=True)
