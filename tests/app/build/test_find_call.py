"""`hypernav.find` is the search of the command, in one call."""

import json
import math
from dataclasses import replace
from inspect import unwrap
from math import pi

import pytest

import hypernav
from box_scenes import room_glb
from hypernav import Action, ConfigError, ContractError, Goal, Observation, Pose2
from hypernav.app.cli.main import main
from hypernav.core.embodiment import CameraConfig, Embodiment

SMALL = hypernav.HyPerNavConfig(embodiment=Embodiment(camera=CameraConfig(width=160, height=120)))
CAMERA = ("embodiment.camera.width=160", "embodiment.camera.height=120")


@pytest.fixture(scope="module")
def glb(tmp_path_factory):
    """A room with a bed."""
    return str(room_glb(tmp_path_factory.mktemp("scene") / "room.glb"))


class Idler:
    """Turns until it has turned enough."""

    def reset(self, goal: Goal) -> None:
        self.goal, self.turns = goal, 0

    def act(self, observation: Observation) -> Action | None:
        self.turns += 1
        return Action.TURN_LEFT if self.turns < 4 else None


@pytest.mark.slow
def test_it_takes_the_steps_of_the_command(glb, tmp_path):
    command = ["find", "bed", "--scene", glb, "--seed", "5", "--quiet", "--out", str(tmp_path)]
    with pytest.raises(SystemExit):
        main([*command, "--set", *CAMERA])
    written = [json.loads(line) for line in (tmp_path / "trace.jsonl").read_text().splitlines()]
    search = hypernav.find("bed", glb, config=SMALL, seed=5)
    steps = [(step.trace.step, step.trace.action, step.trace.reason) for step in search]
    assert steps == [(step["step"], step["action"], step["reason"]) for step in written]
    assert search.result().outcome is hypernav.Outcome.FOUND


def test_an_agent_and_a_start_of_ones_own(glb):
    scene, agent = hypernav.load_scene(glb), Idler()
    start = Pose2(2.0, 2.0, pi / 2)
    search = hypernav.find(Goal("bed"), scene, agent=agent, config=SMALL, start=start)
    assert len(list(search)) == 4
    assert search.trial.episode.start == start
    assert agent.goal == Goal("bed")


def test_a_goal_that_the_agent_can_never_see_is_refused(glb):
    class Sofas:
        def check_goal(self, goal: Goal) -> None:
            raise hypernav.GoalError(f"only sofas, no {goal.text}")

    agent = replace(hypernav.build_agent(SMALL), components=(Sofas(),))
    with pytest.raises(hypernav.GoalError, match="only sofas, no bed"):
        hypernav.find("bed", glb, agent=agent, config=SMALL)


def test_an_agent_for_another_robot_is_refused(glb):
    agent = hypernav.build_agent(hypernav.preset("default"))
    with pytest.raises(hypernav.ConfigError, match="another robot"):
        hypernav.find("bed", glb, agent=agent, config=SMALL)


@pytest.mark.parametrize(
    "given",
    [
        {"config": {}}, {"max_steps": 0}, {"max_steps": -1}, {"max_steps": 1.5},
        {"max_steps": math.nan}, {"seed": -1}, {"agent": {}}, {"agent": list},
    ],
    ids=str,
)  # fmt: skip
def test_an_impossible_argument_is_refused_not_replaced(given, glb):
    with pytest.raises((ConfigError, ContractError)):
        unwrap(hypernav.find)("bed", glb, **given)
