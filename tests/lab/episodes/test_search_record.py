import gc
import json
from typing import Any

import pytest

from hypernav.app.build.agents import build_search
from hypernav.core.errors import ConfigError, MissingExtraError, OutputError
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import ExchangeLog
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from small_episodes import episode_from
from small_worlds import small_config, two_rooms


def search(max_steps=6):
    agent = build_search(small_config(), GroundTruthDetector(), ExchangeLog())
    return EpisodeRun(agent, two_rooms(), episode_from(Pose2(2.5, 1.0, 0.0), max_steps=max_steps))


@pytest.fixture(scope="module")
def recorded():
    return search().record()


def test_the_search_runs_to_its_end_with_the_files_of_the_command(recorded):
    assert recorded.result.steps == len(recorded.steps) == 6
    names = {path.name for path in recorded.folder.iterdir()}
    assert {"index.html", "episode.mp4", "map.png", "result.json", "trace.jsonl"} <= names
    written = json.loads((recorded.folder / "result.json").read_text())
    assert written["outcome"] == recorded.result.outcome.value
    assert written["path_length_m"] == recorded.result.metrics.path_length_m


def test_it_shows_film_map_and_figures(recorded):
    shown = recorded._repr_html_()
    assert '<video controls src="data:video/mp4;base64,' in shown
    assert '<img src="data:image/png;base64,' in shown
    assert f"<td>{recorded.result.outcome.value.replace('_', ' ')}</td>" in shown


def test_what_a_goal_says_is_shown_as_text():
    named = episode_from(Pose2(2.5, 1.0, 0.0), goal="<b>bed</b>", max_steps=1)
    agent = build_search(small_config(), GroundTruthDetector(), ExchangeLog())
    shown = EpisodeRun(agent, two_rooms(), named).record()._repr_html_()
    assert "&lt;b&gt;bed&lt;/b&gt;" in shown
    assert "<b>" not in shown


def test_it_saves_itself(recorded, tmp_path):
    page = recorded.save(str(tmp_path / "a" / "b"))
    assert page == tmp_path / "a" / "b" / "index.html"
    assert page.read_bytes() == (recorded.folder / "index.html").read_bytes()
    file = tmp_path / "file"
    file.touch()
    with pytest.raises(OutputError, match=r"file cannot be written"):
        recorded.save(file)


def test_a_temporary_folder_goes_with_the_record_and_a_given_one_stays(tmp_path):
    lost = search(1).record()
    folder = lost.folder
    assert folder.is_dir()
    del lost
    gc.collect()
    assert not folder.exists()
    search(1).record(tmp_path / "kept")
    gc.collect()
    assert (tmp_path / "kept" / "index.html").exists()


def test_a_search_that_has_begun_is_refused():
    begun = search()
    next(iter(begun))
    with pytest.raises(ConfigError, match="has taken 1 steps"):
        begun.record()


def test_steps_become_rows(recorded):
    pandas = pytest.importorskip("pandas")
    frame: Any = recorded.to_pandas()
    assert isinstance(frame, pandas.DataFrame)
    assert len(frame) == 6
    assert frame["reason"].tolist() == [step.reason for step in recorded.steps]
    assert frame.loc[0, ["x", "y", "yaw"]].tolist() == [0.0, 0.0, 0.0]


def test_without_pandas_the_extra_is_named(recorded, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pandas", None)
    with pytest.raises(MissingExtraError, match=r"hypernav\[notebook\]"):
        recorded.to_pandas()
