"""Small maps, observations and traces to show."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from hypernav.core.embodiment import Action
from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.observation import Observation
from hypernav.core.trace import BlockRecord, DetectionRecord, Exchange, Mode, StepTrace

LONG_PROMPT = (
    "You are helping a robot that searches a house. White is free floor, dark is furniture, grey "
    "is unknown. " * 12 + "Which numbered square should the robot visit next? Answer a number."
)


@pytest.fixture
def room() -> OccupancyGrid:
    """A room of 4 by 3 m with walls, its lower left corner at (-1, -2), in a larger unknown."""
    cells = np.full((120, 140), Cell.UNKNOWN, dtype=np.uint8)
    cells[20:80, 30:110] = Cell.OCCUPIED
    cells[21:79, 31:109] = Cell.FREE
    return OccupancyGrid(cells, 0.05, (-2.5, -3.0))


@pytest.fixture
def make_step() -> Callable[..., StepTrace]:
    """Makes a step; every third one asks which block is next."""

    def make(number: int, **changes: Any) -> StepTrace:
        asks = number % 3 == 2
        values: dict[str, Any] = {
            "step": number,
            "pose": (0.1 * number, 0.05 * number - 1.0, 0.3 * number),
            "action": Action.MOVE_FORWARD,
            "mode": Mode.EXPLORE if number else Mode.LOOK_AROUND,
            "reason": "going to block 2",
            "destination": (2.0, 0.0),
            "path": [(0.1 * number, 0.0), (2.0, 0.0)],
            "seconds": {"map": 0.002, "global": 0.5 if asks else 0.0},
        }
        if asks:
            values["blocks"] = [
                BlockRecord(number=1, x_min=-1.0, y_min=-2.0, size_m=1.5),
                BlockRecord(number=2, x_min=0.5, y_min=-2.0, size_m=1.5),
            ]
            values["exchanges"] = [
                Exchange(kind="ground", asked="a model", question="Is it there?", answer="[]"),
                Exchange(
                    kind="choose block",
                    asked="a model",
                    question=LONG_PROMPT,
                    answer="2, because it looks like a kitchen",
                    chosen=2,
                    excluded=[1],
                    probabilities={"1": 0.2, "2": 0.8},
                    tokens_in=100,
                    tokens_out=5,
                    seconds=0.5,
                ),
            ]
        return StepTrace(**(values | changes))

    return make


@pytest.fixture
def sighting() -> DetectionRecord:
    """An accepted detection with a mask."""
    return DetectionRecord(
        box=(40.0, 30.0, 90.0, 80.0),
        score=0.83,
        label="bed",
        outlines=[[(42, 32), (88, 32), (88, 78), (42, 78)]],
        accepted=True,
    )


@pytest.fixture
def observation() -> Observation:
    """A grey image of 160 by 120 pixels."""
    camera, robot = PinholeCamera.from_hfov(160, 120, 79.0), Pose2(0.0, 0.0, 0.0)
    return Observation(
        rgb=np.full((120, 160, 3), 130, dtype=np.uint8),
        depth=np.full((120, 160), 2.0, dtype=np.float32),
        camera=camera,
        camera_to_map=robot.to_transform() @ optical_to_base(0.88),
        robot=robot,
    )


@pytest.fixture
def result() -> dict[str, Any]:
    """What `result.json` holds after a success."""
    return {
        "goal": "bed",
        "scene": "small_house",
        "agent": "hypernav",
        "preset": "default",
        "detector": "ground-truth",
        "reasoner": "geometric",
        "outcome": "found",
        "success": True,
        "spl": 0.61,
        "soft_spl": 0.63,
        "steps": 12,
        "path_length_m": 23.5,
        "shortest_path_m": 14.4,
        "distance_to_goal_m": 0.04,
        "model_calls": 3,
        "seconds": {"total": 10.0, "map": 0.5, "local": 7.0, "plan": 0.1},
        "config": {"mapping": {"resolution_m": 0.05}, "url": "http://localhost:8000/v1"},
    }
