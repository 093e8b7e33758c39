"""What `scripts/release.py` refuses, and what it writes."""

import datetime
import importlib
import subprocess

import pytest

CHANGELOG = "# Changelog\n\n## 0.1.0 (unreleased)\n\nFirst version.\n"


@pytest.fixture
def release():
    return importlib.import_module("release")  # pytest's own path holds scripts/


def git(folder, *arguments):
    who = ("-c", "user.name=a", "-c", "user.email=a@b.c")
    subprocess.run(["git", *who, *arguments], cwd=folder, check=True, capture_output=True)


@pytest.fixture
def checkout(tmp_path):
    (tmp_path / "pyproject.toml").write_text('[project]\nversion = "0.1.0"\n')
    (tmp_path / "CHANGELOG.md").write_text(CHANGELOG)
    git(tmp_path, "init", "--quiet", "--initial-branch", "main")
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "--quiet", "--message", "Begin")
    return tmp_path


def test_a_clean_checkout_with_version_and_changelog_is_ready(release, checkout):
    assert list(release.obstacles("0.1.0", checkout)) == []


def test_all_that_is_missing_is_said_at_once(release, checkout):
    (checkout / "new").touch()
    git(checkout, "tag", "v0.2.0")
    git(checkout, "switch", "--quiet", "--create", "other")
    said = "\n".join(release.obstacles("0.2.0", checkout))
    for words in ("version 0.1.0", "no '## 0.2.0 (un", "has changes", "'other'", "tag v0.2.0"):
        assert words in said


def test_the_changelog_gets_the_day(release, checkout):
    release.date_changelog("0.1.0", checkout, datetime.date(2027, 1, 2))
    assert "## 0.1.0 (2027-01-02)\n" in (checkout / "CHANGELOG.md").read_text()


def test_this_checkout_names_its_version_in_both_places(release):
    said = "\n".join(release.obstacles("0.1.0", release._ROOT))
    assert "pyproject" not in said
    assert "CHANGELOG" not in said
