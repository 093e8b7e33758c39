import math
import subprocess
import sys

import gymnasium
import numpy as np
import pytest

import hypernav
from box_scenes import room_boxes, scene_of
from hypernav.app.build.agents import build_search
from hypernav.app.build.env import ObjectNavConfig, ObjectNavEnv
from hypernav.core.embodiment import Action, CameraConfig, Embodiment
from hypernav.core.errors import ContractError
from hypernav.core.trace import Ending, ExchangeLog, Mode, StepTrace
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.simulator.worlds.box_room import BoxRoom
from small_worlds import small_config

CONFIG = ObjectNavConfig(embodiment=Embodiment(camera=CameraConfig(width=32, height=24)))
SCENE = scene_of(*room_boxes(), ("bed", (4.4, 1.0, 0.0), (6.0, 3.0, 0.5)))


class Turner:
    """Keeps the contract with the least effort."""

    def reset(self, goal):
        self.step = -1

    def act(self, observation):
        self.step += 1
        self.observation = observation
        return Action.TURN_LEFT


def agent(**methods):
    """A `Turner` with other methods."""
    return type("Odd", (Turner,), methods)()


def world():
    return ObjectNavEnv(SCENE, "bed", config=CONFIG)


@pytest.mark.parametrize("name", ["hypernav", "frontier"])
@pytest.mark.parametrize("preset", ["default", "paper"])
def test_our_own_agents_keep_the_contract(name, preset):
    config = small_config(preset)
    hypernav.check_agent(build_search(config, GroundTruthDetector(), ExchangeLog(), agent=name))


def test_the_least_agent_keeps_the_contract():
    hypernav.check_agent(Turner())


def test_our_own_world_keeps_the_contract():
    hypernav.check_world(world())


def forgets_nothing(self, goal):
    self.step = getattr(self, "step", -1)


def turns_then_goes(self, observation):
    self.step += 1
    return Action.TURN_LEFT if self.step < 40 else Action.MOVE_FORWARD


def paints(self, observation):
    observation.rgb[:] = 0
    return Action.TURN_LEFT


def explained(**values):
    def last_step(self):
        robot = self.observation.robot
        told = {
            "step": self.step,
            "pose": (robot.x, robot.y, robot.yaw),
            "action": Action.TURN_LEFT,
            "mode": Mode.EXPLORE,
        }
        return StepTrace(**(told | values))

    return agent(last_step=property(last_step), grid=None)


@pytest.mark.parametrize(
    ("odd", "words"),
    [
        (object(), "no method reset"),
        (agent(act=None), "no method act"),
        (agent(act=lambda self, observation: 2), r"act returned 2, .* return Action\(2\)"),
        (agent(act=lambda self, observation: "left"), "act returned 'left', expected an Action"),
        (agent(act=lambda self, observation: False), "act returned False, expected an Action"),
        (agent(act=paints), "act changed the observation's images"),
        (agent(reset=forgets_nothing, act=turns_then_goes), "reset must forget"),
        (agent(grid=None), "it has grid alone"),
        (explained(action=Action.STOP), "last_step.action is"),
        (explained(step=7), "last_step.step is 7"),
        (explained(pose=(9.0, 9.0, 0.0)), "last_step.pose is"),
        (explained(), "grid is NoneType"),
    ],
)
def test_what_breaks_an_agents_contract_is_said(odd, words):
    with pytest.raises(ContractError, match=words):
        hypernav.check_agent(odd)


def test_an_agent_may_give_up():
    hypernav.check_agent(agent(act=lambda self, observation: None))


def test_a_claim_in_the_trace_must_be_the_one_that_the_action_makes():
    with pytest.raises(ContractError, match=r"last_step\.ending is"):
        hypernav.check_agent(explained(ending=Ending.GAVE_UP))


def test_an_agent_may_draw_at_random_if_one_says_so():
    rng = np.random.default_rng(0)
    odd = agent(act=lambda self, observation: Action(int(rng.integers(1, 4))))
    with pytest.raises(ContractError, match="seed whatever is drawn"):
        hypernav.check_agent(odd)
    hypernav.check_agent(odd, repeatable=False)


def test_what_an_agent_raises_comes_through_with_a_note():
    def fails(self, observation):
        return {}["nothing"]

    with pytest.raises(KeyError) as error:
        hypernav.check_agent(agent(act=fails))
    assert error.value.__notes__ == ["raised while the checker called act(observation) at step 0"]


class Changed(ObjectNavEnv):
    """A world with something wrong about it."""

    def reset(self, *, seed=None, options=None):
        seen, info = super().reset(seed=seed, options=options)
        return self.see(seen), self.inform(info)

    def step(self, action):
        seen, reward, terminated, truncated, info = super().step(self.do(action))
        return self.see(seen), reward, self.end(terminated), truncated, self.inform(info)

    see = inform = do = end = staticmethod(lambda value: value)


def mirrored(seen):
    return seen | {"pose": seen["pose"] * [1, -1, -1]}


def sideways(seen):
    x, y, yaw = seen["pose"]
    return seen | {"pose": np.array([-x, y, yaw])}


def shifted(seen):
    return seen | {"pose": seen["pose"] + [1.0, 0.0, 0.0]}


def unmeasured(info):
    return {key: value for key, value in info.items() if key != "soft_spl"}


def negative(seen):
    return seen | {"depth": seen["depth"] - np.float32(9.0)}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"see": mirrored}, "TURN_LEFT changed the yaw by -30"),
        ({"see": sideways}, "x is forward"),
        ({"see": shifted}, "expected \\(0, 0, 0\\)"),
        ({"see": negative}, "depth"),
        ({"inform": unmeasured}, "info lacks soft_spl"),
        ({"inform": lambda info: info | {"path_length_m": 0.0}}, "path_length_m grew by 0.00"),
        ({"inform": lambda info: info | {"success": True}}, "success without STOP"),
        ({"do": lambda action: 2 if action == 1 else action}, "did not move the robot at all"),
        ({"do": lambda action: 2 if action == 3 else action}, "TURN_LEFT and TURN_RIGHT end"),
        ({"end": lambda terminated: False}, "STOP did not terminate"),
    ],
)
def test_what_breaks_a_worlds_contract_is_said(changes, words):
    methods = {name: staticmethod(change) for name, change in changes.items()}
    with pytest.raises(ContractError, match=words):
        hypernav.check_world(type("OddWorld", (Changed,), methods)(SCENE, "bed", config=CONFIG))


def test_what_is_no_environment_is_told_what_one_is():
    with pytest.raises(ContractError, match=r"no gymnasium\.Env"):
        hypernav.check_world(object())


def test_a_world_without_depth_is_named():
    env = world()
    spaces = env.observation_space
    assert isinstance(spaces, gymnasium.spaces.Dict)
    env.observation_space = gymnasium.spaces.Dict({"rgb": spaces["rgb"]})
    with pytest.raises(ContractError, match="lack depth, pose, goal"):
        hypernav.check_world(env)


def test_the_room_of_the_check_is_as_deep_as_it_is():
    seen = BoxRoom().observe()
    assert seen.depth[60, 80] == pytest.approx(4.0, abs=1e-4)  # the wall ahead, 4 m away
    floor_row = 119
    below = 0.88 * seen.camera.fy / (floor_row + 0.5 - seen.camera.cy)
    assert seen.depth[floor_row, 80] == pytest.approx(below, rel=1e-5)
    room = BoxRoom()
    for _ in range(12):
        room.step(Action.TURN_LEFT)
    assert math.isclose(room.pose.yaw, 0.0, abs_tol=1e-9)


def test_importing_hypernav_stays_light():
    program = "import sys, hypernav; print('numpy' in sys.modules, 'numba' in sys.modules)"
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == ["False", "False"]
    with pytest.raises(AttributeError, match="no attribute 'nothing'"):
        hypernav.nothing  # noqa: B018
