"""One page over all runs in a folder: what it holds, and the page in a browser."""

import json
import os
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from selenium import webdriver
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import Select

from browsers import chromium
from eval_runs import apart, record, spec
from hypernav.app.cli.evaluation.runs import run
from hypernav.app.cli.options.commands import RunsOptions
from hypernav.core.errors import RunFolderError
from hypernav.lab.evaluation.failures import Failure
from hypernav.lab.evaluation.report.runs_page import changed, overview, run_folders
from hypernav.lab.evaluation.run_plan import RunPlan
from hypernav.lab.evaluation.runner import RunSession
from hypernav.lab.evaluation.store.run_store import RunStore

RESULT = {
    "goal": "bed",
    "scene": "builtin",
    "agent": "hypernav",
    "preset": "default",
    "detector": "ground truth",
    "model": "none",
    "commit": "abc1234",
    "outcome": "found",
    "success": True,
    "spl": 0.7,
    "steps": 41,
    "path_length_m": 6.5,
}


def write_run(folder: Path, agent: str, *records) -> None:
    who = {"agent": agent, "preset": "default", "detector": "ground truth", "reasoner": "none"}
    episodes = [spec(one.episode_id) for one in records]
    configuration = RunPlan("houses-val", who=who).configuration(episodes)
    with RunStore(folder, configuration) as store, RunSession(store, 1):
        for one in records:
            store.add(one)


def write_search(folder: Path, **changes) -> None:
    folder.mkdir(parents=True)
    (folder / "result.json").write_text(json.dumps(RESULT | changes))
    (folder / "index.html").write_text("<title>a page</title>")
    (folder / "episode.mp4").write_bytes(b"a film")


@pytest.fixture
def root(tmp_path: Path) -> Path:
    root = tmp_path / "runs"
    write_run(root / "ours", "hypernav", record("0"), record("1", spl=0.9), apart("2"))
    lost = record("1", failure=Failure.NEVER_SEEN, why="it never saw the bed")
    write_run(root / "nearest", "frontier", record("0", spl=0.3), lost)
    write_search(root / "2026" / "first search")
    return root


def test_every_run_and_search_below_the_folder_is_shown(root: Path) -> None:
    found = overview(root)
    assert sorted(one["name"] for one in found.runs) == ["2026/first search", "nearest", "ours"]
    assert len(found.searches) == 6
    assert found.left_out == []
    search = next(one for one in found.searches if one["building"] == "builtin")
    assert search["film"] == "2026/first%20search/episode.mp4"
    assert search["page"] == "2026/first%20search/index.html"


def test_spl_is_not_rounded_before_its_mean(tmp_path: Path) -> None:
    write_run(tmp_path / "ours", "hypernav", record("0", spl=0.6865036832468938))
    assert [one["spl"] for one in overview(tmp_path).searches] == [0.6865036832468938]


def test_an_ablation_is_shown_by_its_variants(tmp_path: Path) -> None:
    write_run(tmp_path / "abl" / "unchanged", "hypernav", record("0"))
    whole = json.loads((tmp_path / "abl" / "unchanged" / "run.json").read_text())
    whole["configuration"]["study"] = {"variants": ["unchanged"]}
    (tmp_path / "abl" / "run.json").write_text(json.dumps(whole))
    found = overview(tmp_path)
    assert [one["name"] for one in found.runs] == ["abl/unchanged"]
    assert found.left_out == []


def test_a_run_says_which_of_its_values_are_not_the_usual_ones(tmp_path: Path) -> None:
    for name, agent, steps in (("a", "hypernav", 40), ("b", "frontier", 40), ("c", "vlfm", 10)):
        search = {"endurance_steps": steps, "max_steps": 500}
        write_search(tmp_path / name, agent=agent, config={"search": search})
    runs = {one["name"]: one["differs"] for one in overview(tmp_path).runs}
    assert runs == {"a": "", "b": "", "c": "search.endurance_steps 10"}


@pytest.mark.parametrize(
    ("outcome", "state"), [("interrupted", "interrupted"), ("not_found", "finished")]
)
def test_only_a_search_that_came_to_its_end_is_finished(
    outcome: str, state: str, tmp_path: Path
) -> None:
    write_search(tmp_path / "search", outcome=outcome)
    assert overview(tmp_path).runs[0]["ended"] == state


def test_searches_from_other_starts_are_not_the_same(tmp_path: Path) -> None:
    for name, x in (("a", 1.0), ("b", 1.0), ("c", 2.0)):
        write_search(tmp_path / name, start=[x, 0.0, 0.0], seed=0)
    keys = [one["key"] for one in overview(tmp_path).searches]
    assert len(set(keys)) == 2


def test_an_outage_counts_in_no_rate(root: Path) -> None:
    outcomes = {one["key"]: one["counts"] for one in overview(root).searches if one["run"] == 0}
    for one in overview(root).searches:
        assert one["counts"] == (one["outcome"] != Failure.MODEL_UNAVAILABLE.words)
    assert outcomes


def test_pages_of_single_episodes_are_no_runs_of_their_own(root: Path) -> None:
    write_search(root / "ours" / "episodes" / "house-0")
    assert len(overview(root).searches) == 6


@pytest.mark.parametrize("content", ["{", "[]", '{"outcome": "lost"}', '{"goal": "bed"}'])
def test_a_damaged_folder_is_named_and_not_hidden(root: Path, content: str) -> None:
    (root / "2026" / "first search" / "result.json").write_text(content)
    found = overview(root)
    assert len(found.runs) == 2
    assert ["first search" in line for line in found.left_out] == [True]


def test_the_page_is_made_anew_when_an_episode_ends(root: Path) -> None:
    before = changed(root)
    configuration = json.loads((root / "nearest" / "run.json").read_text())["configuration"]
    with RunStore(root / "nearest", configuration) as store:
        store.add(record("7"))
    assert changed(root) > before
    assert len(overview(root).searches) == 7


def test_a_run_says_of_which_commit_it_is(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("hypernav.lab.evaluation.runner.commit", lambda: "1234abc+")
    write_run(tmp_path / "run", "hypernav", record())
    assert overview(tmp_path).runs[0]["commit"] == "1234abc+"


def test_a_folder_whose_name_is_no_text_is_shown(tmp_path: Path) -> None:
    write_search(tmp_path / os.fsdecode(b"latin \xe9"))
    run(RunsOptions(tmp_path, quiet=True))
    assert "latin%20%E9/episode.mp4" in (tmp_path / "runs.html").read_text()


def test_a_run_in_the_deepest_folder_is_found(tmp_path: Path) -> None:
    folders = [tmp_path]
    for _ in range(1000):
        folders.append(folders[-1] / "d")
        folders[-1].mkdir()
    write_search(folders[-1] / "run")
    assert list(run_folders(tmp_path)) == [folders[-1] / "run"]
    for folder in reversed(folders[1:]):  # no cleaner of folders goes as deep
        shutil.rmtree(folder)


def test_the_command_refuses_a_folder_without_runs(tmp_path: Path) -> None:
    with pytest.raises(RunFolderError, match="holds no run"):
        run(RunsOptions(tmp_path))
    with pytest.raises(RunFolderError, match="no folder"):
        run(RunsOptions(tmp_path / "nowhere"))
    assert list(tmp_path.iterdir()) == []


@pytest.fixture(scope="module")
def browser() -> Iterator[webdriver.Chrome]:
    with chromium() as browser:
        yield browser


@pytest.mark.slow
def test_two_runs_are_compared_by_a_click(root: Path, browser: webdriver.Chrome) -> None:
    run(RunsOptions(root, quiet=True))
    browser.get((root / "runs.html").as_uri())

    def row(table: str, words: str) -> None:
        rows = browser.find_elements(By.CSS_SELECTOR, f"#{table} tbody tr")
        next(one for one in rows if words in one.text).click()

    row("runs", "ours")
    row("runs", "nearest")
    chosen = browser.find_element(By.ID, "chosen")
    assert "2 searches that both have made" in chosen.text
    assert "100.0 %" in chosen.text
    assert "50.0 %" in chosen.text
    assert "−50.0 points" in chosen.text
    assert "Only ours found (1)" in chosen.text
    browser.refresh()  # what was chosen stays
    assert "Only ours found (1)" in browser.find_element(By.ID, "chosen").text
    filters = Select(browser.find_element(By.CSS_SELECTOR, "[data-filter=building]"))
    filters.select_by_visible_text("builtin")
    assert "1 of 6 searches" in browser.find_element(By.ID, "counted").text
    row("searches", "builtin")
    film = browser.find_element(By.CSS_SELECTOR, "#chosen video")
    assert (film.get_attribute("src") or "").endswith("first%20search/episode.mp4")
