"""The words of the pages: what holds today in plain words, and no history, which is in git."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = [*sorted(ROOT.glob("docs/**/*.md")), *sorted(ROOT.glob("*.md"))]
NO_PROSE = re.compile(
    r"^ *```.*?^ *```$|<!--.*?-->|<details.*?</details>|`[^`\n]+`|\]\([^)]*\)|<https?:[^>]*>",
    re.DOTALL | re.MULTILINE,
)
"""Blocks of code, comments, folded details, code within a sentence, and addresses."""
REFUSED = {
    r"(?=\w*\d)(?=\w*[a-f])\b[0-9a-f]{7,40}\b": "a commit: say what holds today",
    r"\bcommits? (?=\w*\d)[0-9a-f]{4,}": "a commit: say what holds today",
    r"\bcounts? for none\b": "is ignored",
    r"\bthat (?:are|is) told\b": "shown in the report",
    r"\b(?:was|were) looked at while\b": "used during development",
    r"\bnobody looks at\b": "what nothing uses",
    r"\bnobody shall\b": "must not",
    r"\bof which nothing was heard\b": "the oldest",
    r"\bgets? onto stairs down\b": "starts the descent",
    r"\bdrawn by a standard normal number\b": "compares a standard normal variable",
}
"""What the pages don't say, and what instead."""


def faults(text: str) -> Iterator[str]:
    """What a page says that it should not, each with its line."""
    prose = NO_PROSE.sub(lambda found: "\n" * found[0].count("\n"), text)
    for words, better in REFUSED.items():
        for found in re.finditer(words.replace(" ", r"\s+"), prose, re.IGNORECASE):
            line = prose.count("\n", 0, found.start()) + 1
            yield f"{line}: '{found[0]}' ({better})"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_a_page_says_what_holds_today_in_plain_words(page: Path):
    assert list(faults(page.read_text("utf-8"))) == []


def test_a_commit_and_an_odd_phrase_are_found_in_sentences_alone():
    assert list(faults("One.\nBy efb53201 16 more are found.")) == [
        "2: 'efb53201' (a commit: say what holds today)"
    ]
    assert len(list(faults("Such an edge counts\nfor none, as at commit 1234."))) == 2
    hidden = "Run `git show efb53201`.\n\n```\nefb53201\n```\n\n<!-- efb53201 -->"
    assert not list(faults(f"{hidden}\n[a page](https://x.org/efb53201) of 16777216 in defaced"))


CODE = re.compile(r"`([^`\n]+)`")
FILE = re.compile(r"(?<![\w./-])(?:src/|hypernav/)*([a-z]+/[\w./-]*\w/?)")
HOMES = (ROOT, ROOT / "src", ROOT / "src" / "hypernav")
OURS = {one.name for home in (HOMES[0], HOMES[2]) for one in home.iterdir() if one.is_dir()}


def lost_files(text: str) -> list[str]:
    """The files and folders of this repository that a page names, and that don't exist."""
    named = {name for code in CODE.findall(text) for name in FILE.findall(code)}
    ours = {name for name in named if name.partition("/")[0] in OURS}
    return sorted(name for name in ours if not any((home / name).exists() for home in HOMES))


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_a_page_names_files_that_exist(page: Path):
    assert lost_files(page.read_text("utf-8")) == []


def test_a_file_that_was_moved_is_missed():
    assert lost_files("see `pytest tests/nowhere/test_x.py`, `tests/search/` and `/map`") == [
        "tests/nowhere/test_x.py"
    ]
