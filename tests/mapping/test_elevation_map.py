"""What an image shows of the ground around the robot."""

import numpy as np

from box_views import FLOOR, SolidBox, view_of
from hypernav.core.geometry.transforms import Pose2
from hypernav.mapping.elevation_map import ElevationMap
from stair_views import CAMERA, CLIMBER


def test_the_edge_of_what_hangs_before_a_wall_is_no_ground():
    """Above the pixel that shows the wall lies one that shows the edge, nearer and as high."""
    hanging: SolidBox = ((1.7, -2.0, 0.5), (1.9, 2.0, 1.4))
    wall: SolidBox = ((2.0, -2.0, 0.0), (2.2, 2.0, 1.4))
    heights = ElevationMap(CLIMBER, 0.05)
    heights.integrate(view_of([FLOOR, hanging, wall], Pose2(0.0, 0.0, 0.0), camera=CAMERA))
    ground = heights.ground_from((0.0, 0.0))
    assert ground.seen.sum() > 100
    assert np.abs(ground.measured[ground.seen]).max() < 0.02
