"""Make a release: check that all is ready, build wheel and sdist, date the changelog, and tag.

Nothing is pushed or uploaded: the last lines say how. Run `.ci/run` and `make freeze` before.

Run: python scripts/release.py 0.1.0 [--dry-run]
"""

import argparse
import datetime
import re
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from pathlib import Path

_ROOT = Path(__file__).parents[1]


def main() -> int:
    """Make a release.

    Returns:
        The exit status: 0 if it is tagged, or with ``--dry-run`` could be.
    """
    parser = argparse.ArgumentParser(description="Build, date and tag a release.")
    parser.add_argument("version")
    parser.add_argument("--dry-run", action="store_true", help="only say what is missing")
    options = parser.parse_args()
    missing = list(obstacles(options.version, _ROOT))
    for one in missing:
        print(one, file=sys.stderr)
    if missing or options.dry_run:
        return 1 if missing else 0
    subprocess.run(["make", "wheel"], cwd=_ROOT, check=True)  # before anything is written
    date_changelog(options.version, _ROOT, datetime.date.today())
    tag = f"v{options.version}"
    _git(_ROOT, "commit", "--quiet", "CHANGELOG.md", "--message", f"Release {options.version}")
    _git(_ROOT, "tag", "--annotate", tag, "--message", f"hypernav {options.version}")
    print(f"tagged {tag}. What is left:\n  git push origin main {tag}\n  twine upload dist/*")
    return 0


def obstacles(version: str, root: Path) -> Iterator[str]:
    """What stands in the way of a release, each with what to do."""
    project = tomllib.loads((root / "pyproject.toml").read_text("utf-8"))["project"]
    if project["version"] != version:
        yield f"pyproject.toml says version {project['version']}, not {version}: change one of them"
    if not _heading(version).search((root / "CHANGELOG.md").read_text("utf-8")):
        yield f"CHANGELOG.md has no '## {version} (unreleased)': write what a user notices"
    if _git(root, "status", "--porcelain"):
        yield "the checkout has changes: commit them, or put them aside"
    if (branch := _git(root, "branch", "--show-current")) != "main":
        yield f"this is the branch '{branch}': releases are made from main"
    if _git(root, "tag", "--list", f"v{version}"):
        yield f"there is a tag v{version} already: take another version"


def date_changelog(version: str, root: Path, day: datetime.date) -> None:
    """Put the day in place of "unreleased"."""
    path = root / "CHANGELOG.md"
    text = _heading(version).sub(f"## {version} ({day})", path.read_text("utf-8"))
    path.write_text(text, "utf-8")


def _heading(version: str) -> re.Pattern[str]:
    return re.compile(rf"^## {re.escape(version)} \(unreleased\)$", re.MULTILINE)


def _git(root: Path, *arguments: str) -> str:
    done = subprocess.run(
        ["git", *arguments], cwd=root, check=True, stdout=subprocess.PIPE, text=True
    )
    return done.stdout.strip()


if __name__ == "__main__":
    sys.exit(main())
