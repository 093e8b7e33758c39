"""The world of another simulator shows what our own shows of the same shapes."""

import importlib
import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import hypernav
from hypernav.core.geometry.camera import optical_to_base
from hypernav.core.geometry.transforms import Pose2

EXAMPLES = Path(__file__).parents[2] / "examples"

pytestmark = pytest.mark.slow


@pytest.fixture
def example(monkeypatch: pytest.MonkeyPatch) -> Any:
    monkeypatch.syspath_prepend(str(EXAMPLES))
    monkeypatch.setenv("MUJOCO_GL", os.environ.get("MUJOCO_GL", "egl"))
    return importlib.import_module("08_mujoco_world")


def test_mujoco_draws_what_our_own_renderer_draws(example):
    config = hypernav.HyPerNavConfig()
    theirs = example.mujoco_world(config)
    ours = hypernav.SimulatedWorld(theirs.scene, config.world, config.embodiment)
    for start in (Pose2(1.5, 1.2, 0.3), Pose2(4.5, 1.5, -2.5), Pose2(2.0, 2.4, 1.6)):
        eye = start.to_transform(0.0) @ optical_to_base(config.embodiment.camera.height_m, 20.0)
        seen, expected = theirs.view_from(eye), ours.view_from(eye)
        same = seen.instance_ids == expected.instance_ids
        assert same.mean() > 0.99  # all but the edges
        assert np.median(np.abs(seen.depth - expected.depth)[same]) < 1e-3
        assert seen.rgb.std() > 10.0
        assert not theirs.view_from(eye, colours=False).rgb.any()
    theirs.close()


def test_a_world_of_ones_own_keeps_the_contract_and_serves_by_name(example):
    world = hypernav.ObjectNavEnv(example.mujoco_world(hypernav.HyPerNavConfig()))
    hypernav.check_world(world)
    world.world.close()
