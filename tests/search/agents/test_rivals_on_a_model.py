"""The published methods with a chat model that tells the truth."""

import math
from collections.abc import Iterator

import pytest

from hypernav.app.build.agents import build_agent
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.native import native_config
from hypernav.core.episode import Outcome
from hypernav.core.geometry.transforms import Pose2
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.simulator.worlds.simulation import SimulatedWorld
from servers.scripted import ScriptedServer
from servers.truth import Truth, TruthfulBrain, watching
from small_episodes import episode_from
from small_worlds import small_config, two_rooms

START = Pose2(2.5, 1.0, math.pi / 2)
QUICK = {"timeout_s": 5.0, "patience_s": 10.0, "first_wait_s": 0.01, "longest_wait_s": 0.1}


@pytest.fixture
def server() -> Iterator[ScriptedServer]:
    with ScriptedServer() as server, watching(Truth()) as truth:
        server.brain = TruthfulBrain(truth)
        yield server


def searched(server: ScriptedServer, agent: str, detector: str | None):
    specs = ComponentSpecs(agent=agent, vlm=server.spec, detector=detector)
    parts = build_agent(small_config(chat=QUICK), specs)
    run = EpisodeRun(parts.agent, two_rooms(), episode_from(START, "bed", max_steps=200))
    steps = [step.trace for step in run if step.trace is not None]
    kinds = {one.kind for step in steps for one in step.exchanges if one.by_model}
    return run.result(), kinds, parts


@pytest.mark.parametrize(
    ("agent", "kind"),
    [
        ("vlfm", "score view"),
        ("navvlm", "choose direction"),
        ("vlmnav", "choose arrow"),
        ("pivot", "choose arrow"),
        ("dynavlm-style", "choose arrow"),
    ],
)
def test_the_bed_is_found_by_what_the_model_says(server: ScriptedServer, agent: str, kind: str):
    result, kinds, parts = searched(server, agent, "ground-truth")
    assert result.outcome is Outcome.FOUND
    assert kind in kinds
    assert "verify" in kinds  # the presence check that all agents share
    # Nothing stands in for anything but the detector.
    assert parts.warnings == ["no detector runs: the simulator gives true labels"]
    assert "stand-in" not in parts.reasoner_words


def test_one_model_can_do_all(server: ScriptedServer):
    result, kinds, _ = searched(server, "vlmnav", None)
    assert result.outcome is Outcome.FOUND
    assert {"ground", "choose arrow", "verify"} <= kinds


@pytest.mark.parametrize("agent", ["vlmnav", pytest.param("pivot", marks=pytest.mark.slow)])
def test_in_native_mode_the_model_is_asked_to_stop_and_nothing_is_detected(
    server: ScriptedServer, agent: str
):
    config = native_config(agent, small_config(chat=QUICK))
    camera = config.embodiment.camera.model_copy(update={"width": 160, "height": 90})
    robot = config.embodiment.model_copy(update={"camera": camera})
    config = config.model_copy(update={"embodiment": robot})
    world = SimulatedWorld(two_rooms().scene, config.world, robot)
    parts = build_agent(config, ComponentSpecs(agent=agent, vlm=server.spec, native=True))
    run = EpisodeRun(parts.agent, world, episode_from(START, "bed", max_steps=300))
    kinds = {one.kind for step in run for one in step.trace.exchanges if one.by_model}
    assert kinds == {"stop", "choose arrow"}
    assert parts.warnings == []
    assert parts.take_report()["fallbacks"]["moves"] > 0
