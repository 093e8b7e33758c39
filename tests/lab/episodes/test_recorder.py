import json
import shutil
from dataclasses import replace

import av
import numpy as np
import pytest
import yaml

from hypernav.app.build.agents import build_search
from hypernav.core.errors import OutputError
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import ExchangeLog, StepTrace
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.lab.episodes.recorder import OUTPUT_FILES, EpisodeRecorder
from hypernav.search.mapping.ros_map import load_ros_map
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from small_episodes import episode_from
from small_worlds import small_config, two_rooms


def episode():
    agent = build_search(small_config(), GroundTruthDetector(), ExchangeLog())
    return EpisodeRun(agent, two_rooms(), episode_from(Pose2(2.5, 1.0, 0.0), max_steps=16))


def recorder(folder):
    return EpisodeRecorder(
        folder, goal="bed", agent="hypernav", detector="truth", reasoner="none", step_limit=16
    )


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    folder = tmp_path_factory.mktemp("recorded")
    with recorder(folder) as files:
        for step in episode():
            files.add(step.trace, step.grid, step.observation)
        files.finish({"goal": "bed", "outcome": "not_found", "distance_to_goal_m": float("inf")})
    return folder, files.steps


def test_every_file_is_there(recorded):
    folder, _ = recorded
    assert {path.name for path in folder.iterdir()} == {
        "episode.mp4",
        "index.html",
        "map.pgm",
        "map.png",
        "map.yaml",
        "result.json",
        "timings.jsonl",
        "trace.jsonl",
        "trajectory.tum",
    }


def test_the_trace_reads_back_as_it_was(recorded):
    folder, steps = recorded
    lines = (folder / "trace.jsonl").read_text().splitlines()
    read = [StepTrace.model_validate_json(line) for line in lines]
    assert read == [step.model_copy(update={"seconds": {}}) for step in steps]
    timings = [json.loads(line) for line in (folder / "timings.jsonl").read_text().splitlines()]
    assert timings == [{"step": step.step, "seconds": step.seconds} for step in steps]


def test_infinite_lengths_are_null_in_json(recorded):
    folder, _ = recorded
    assert json.loads((folder / "result.json").read_text())["distance_to_goal_m"] is None


def test_the_trajectory_has_a_line_a_step_with_unit_quaternions(recorded):
    folder, steps = recorded
    rows = [
        [float(number) for number in line.split()]
        for line in (folder / "trajectory.tum").read_text().splitlines()
    ]
    assert len(rows) == len(steps)
    for row, step in zip(rows, steps, strict=True):
        assert row[1:3] == pytest.approx(step.pose[:2], abs=1e-5)
        assert sum(value**2 for value in row[4:]) == pytest.approx(1.0)


def test_the_trajectory_has_the_robots_height(tmp_path):
    heights_m = [0.0, 0.17, 3.012]
    with recorder(tmp_path) as files:
        for step, z in zip(episode(), heights_m, strict=False):
            raised = step.trace.model_copy(update={"z": z})
            files.add(raised, step.grid, step.observation)
        files.finish({"goal": "bed", "outcome": "interrupted"})
    rows = (tmp_path / "trajectory.tum").read_text().splitlines()
    assert [float(row.split()[3]) for row in rows] == heights_m


def test_the_ros_map_is_named_in_its_yaml(recorded):
    folder, _ = recorded
    assert yaml.safe_load((folder / "map.yaml").read_text())["image"] == "map.pgm"


def steps_over_floors(*floors):
    """Steps of a search, each on a floor of its own number."""
    return [
        replace(step, trace=step.trace.model_copy(update={"floor": floor}))
        for step, floor in zip(episode(), floors, strict=False)
    ]


def test_every_floor_leaves_its_map(tmp_path):
    with recorder(tmp_path) as files:
        for width, step in enumerate(steps_over_floors(None, None, 2, 3), start=1):
            grid = OccupancyGrid(np.full((1, width), Cell.FREE, np.uint8), 0.05, (0.0, 0.0))
            files.add(step.trace, grid, step.observation)
        files.finish({"goal": "bed", "outcome": "interrupted"})
    widths = {
        name: load_ros_map(tmp_path / f"{name}.yaml").cells.shape[1]
        for name in ("map_floor_1", "map_floor_2", "map_floor_3", "map")
    }
    assert widths == {"map_floor_1": 2, "map_floor_2": 3, "map_floor_3": 4, "map": 4}
    assert all((tmp_path / f"{name}.png").is_file() for name in widths)


def test_maps_of_floors_of_an_earlier_search_are_gone(tmp_path):
    for floors in ((1, 2), (1, 1)):
        with recorder(tmp_path) as files:
            for step in steps_over_floors(*floors):
                files.add(step.trace, step.grid, step.observation)
            files.finish({"goal": "bed", "outcome": "interrupted"})
    assert not list(tmp_path.glob("map_floor_*"))
    assert (tmp_path / "map.yaml").is_file()


def test_leaving_early_keeps_trace_and_a_playable_video(tmp_path):
    def leave_after_three_steps():
        with recorder(tmp_path) as files:
            for count, step in enumerate(episode()):
                files.add(step.trace, step.grid, step.observation)
                if count == 2:
                    raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        leave_after_three_steps()
    assert len((tmp_path / "trace.jsonl").read_text().splitlines()) == 3
    with av.open(str(tmp_path / "episode.mp4")) as video:
        assert sum(1 for _ in video.decode(video=0)) >= 3


def test_a_folder_that_became_a_file_names_what_could_not_be_written(tmp_path):
    folder = tmp_path / "out"
    with recorder(folder) as files:
        for step in episode():
            files.add(step.trace, step.grid, step.observation)
        shutil.rmtree(folder)
        folder.touch()
        with pytest.raises(OutputError, match=r"^.*out: result\.json, .* could not be written"):
            files.finish({"goal": "bed", "outcome": "not_found"})


def test_a_file_that_has_another_name_elsewhere_is_replaced_not_written(tmp_path):
    folder, mine = tmp_path / "run", tmp_path / "mine"
    folder.mkdir()
    mine.write_text("mine")
    for name in OUTPUT_FILES:
        (folder / name).hardlink_to(mine)
    with recorder(folder):
        assert mine.stat().st_nlink == 1
    assert mine.read_text() == "mine"
