"""What explorers are shown, without a search around them."""

from collections.abc import Sequence

import numpy as np

from box_views import frame
from hypernav.core.exploring.exploration import ExplorationView
from hypernav.core.exploring.floors import SeenThing
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.search.memory.floor import SearchMemory

_CAMERA = PinholeCamera.from_hfov(8, 6, 79.0)


def exploration_view(
    grid: OccupancyGrid,
    seen: Observation | Pose2,
    search: SearchMemory | None = None,
    *,
    goal: Goal | None = None,
    trajectory: Sequence[tuple[float, float]] | None = None,
    things: Sequence[SeenThing] = (),
    may_be_here: bool = False,
) -> ExplorationView:
    """A view of a map from an observation, or from a pose at which a black image is taken.

    Visits and notes are those of a search; a new one has none.
    """
    if isinstance(seen, Pose2):
        seen = frame(np.zeros((_CAMERA.height, _CAMERA.width), np.float32), seen, _CAMERA)
    search = search or SearchMemory()
    return ExplorationView(
        goal=goal or Goal("bed"),
        observation=seen,
        grid=grid,
        trajectory=[seen.robot.xy] if trajectory is None else trajectory,
        visits=search.visits,
        things=things,
        notes=search.notes,
        may_be_here=may_be_here,
    )
