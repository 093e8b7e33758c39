"""Two searches in an exported house, measured as habitat-lab's own ObjectNav task measured them."""

import json
import math
from pathlib import Path
from typing import Any

import pytest

from hypernav.app.build.presets import HyPerNavConfig
from hypernav.lab.datasets.benchmarks import BENCHMARKS
from hypernav.lab.evaluation.habitat_lab.env import HabitatEnv
from hypernav.lab.evaluation.habitat_lab.task import HabitatTask
from hypernav.lab.evaluation.run_plan import RunPlan
from hypernav.simulator.houses.episodes.splits import load_split
from hypernav.simulator.houses.export.habitat_data import export_split

pytestmark = pytest.mark.slow

SPLIT, NUMBER = "houses-train", 3002
ANSWERS = json.loads(Path(__file__).with_name("habitat_lab_answers.json").read_text())


@pytest.fixture(scope="module")
def env(tmp_path_factory: pytest.TempPathFactory) -> HabitatEnv:
    cache = tmp_path_factory.mktemp("cache")
    dataset = load_split(SPLIT, numbers=range(NUMBER, NUMBER + 1), cache=cache)
    root = tmp_path_factory.mktemp("habitat") / "data"
    export_split(dataset, SPLIT, root, cache=cache)
    base = HyPerNavConfig()
    world = base.world.model_copy(update={"navmesh": "file"})
    robot = BENCHMARKS["hm3d"].embodiment
    config = base.model_copy(update={"embodiment": robot, "world": world})
    folder = root / "datasets" / "objectnav" / "hypernav" / SPLIT
    return HabitatEnv(RunPlan(f"habitat:{folder}", config=config), HabitatTask(sensors=()))


@pytest.mark.parametrize("answer", ANSWERS["episodes"], ids=lambda answer: answer["episode"])
def test_every_step_is_measured_as_in_habitat_lab(env: HabitatEnv, answer: dict[str, Any]) -> None:
    env.current_episode = next(e for e in env.episodes if e.episode_id == answer["episode"])
    observations = [env.reset()]
    distances = [env.get_metrics()["distance_to_goal"]]
    for action in answer["actions"]:
        observations.append(env.step(action))
        distances.append(env.get_metrics()["distance_to_goal"])
    assert distances == pytest.approx(answer["distance_to_goal"], abs=2e-5)
    for ours, gps, compass in zip(observations, answer["gps"], answer["compass"], strict=True):
        assert ours["gps"] == pytest.approx(gps, abs=1e-3)
        turned = float(ours["compass"][0]) - compass
        assert math.remainder(turned, 2.0 * math.pi) == pytest.approx(0.0, abs=1e-3)
    metrics = env.get_metrics()
    assert metrics["collisions"]["count"] == answer["final"]["collisions"]
    for name in ("success", "spl", "soft_spl", "num_steps"):
        assert metrics[name] == pytest.approx(answer["final"][name], abs=5e-4)
