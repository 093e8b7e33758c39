"""Whether what a robot sees at its start is what its memory shows there."""

from pathlib import Path

import numpy as np
import pytest

from box_views import CAMERA, room, view_of
from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import MemoryStartError
from hypernav.core.geometry.transforms import Pose2
from hypernav.mapping.config import MappingConfig
from hypernav.mapping.memory.start import check_start, fit_of
from hypernav.mapping.top_down_map import TopDownMap

HALL = [
    *room(8.0, 6.0),
    ((4.0, 0.0, 0.0), (4.2, 4.0, 2.5)),
    ((6.0, 4.5, 0.0), (7.5, 5.8, 0.9)),
    ((1.0, 0.3, 0.0), (2.0, 1.0, 0.8)),
]


@pytest.fixture(scope="module")
def remembered() -> TopDownMap:
    camera = Embodiment().camera.model_copy(update={"width": CAMERA.width, "height": CAMERA.height})
    map_ = TopDownMap(MappingConfig(), Embodiment().model_copy(update={"camera": camera}))
    for x, y in ((1.0, 2.0), (2.5, 4.5), (5.0, 5.0), (6.0, 2.0)):
        for k in range(12):
            map_.integrate(view_of(HALL, Pose2(x, y, k * np.pi / 6.0)))
    return map_


def standing(x: float, y: float, yaw: float, *, really: Pose2 | None = None, boxes=HALL):
    """An image from one pose, as if the robot stood at another."""
    view = view_of(boxes, really or Pose2(x, y, yaw))
    said = view_of([], Pose2(x, y, yaw))
    return type(view)(view.rgb, view.depth, view.camera, said.camera_to_map, said.robot)


@pytest.mark.parametrize("yaw", np.arange(8) * np.pi / 4.0)
def test_a_robot_that_stands_where_it_says_fits(remembered, yaw):
    fit = fit_of(remembered, standing(2.0, 3.0, yaw))
    assert fit is not None
    assert fit > 0.8


def test_a_chair_that_came_since_changes_little(remembered):
    chair = ((3.0, 2.8, 0.0), (3.5, 3.3, 0.9))
    fit = fit_of(remembered, standing(1.5, 3.0, 0.0, boxes=[*HALL, chair]))
    assert fit is not None
    assert fit > 0.5


@pytest.mark.parametrize(
    "really", [Pose2(6.5, 2.0, 0.0), Pose2(2.0, 3.0, 1.2), Pose2(2.0, 3.0, -1.5)]
)
def test_a_robot_that_stands_elsewhere_is_refused(remembered, really):
    with pytest.raises(MemoryStartError, match=r"at \(2\.0, 3\.0\) is not what home remembers"):
        check_start(remembered, standing(2.0, 3.0, 0.0, really=really), Path("home"))


def test_where_nothing_is_known_nothing_is_refused(remembered):
    far = standing(50.0, 50.0, 0.0, really=Pose2(2.0, 3.0, 0.0))
    assert fit_of(remembered, far) is None
    check_start(remembered, far, Path("home"))
