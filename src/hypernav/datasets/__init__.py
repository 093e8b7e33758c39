"""Episodes: Habitat's ObjectNav and OVON files, read and written."""

from hypernav.datasets.episodes import (
    AgentState,
    Episode,
    EpisodeDataset,
    ObjectGoal,
    ViewPoint,
)
from hypernav.datasets.files import episode_files, read_episodes, write_episodes
from hypernav.datasets.frames import (
    pose_from_habitat,
    pose_to_habitat,
    positions_from_habitat,
    positions_to_habitat,
)

__all__ = [
    "AgentState",
    "Episode",
    "EpisodeDataset",
    "ObjectGoal",
    "ViewPoint",
    "episode_files",
    "pose_from_habitat",
    "pose_to_habitat",
    "positions_from_habitat",
    "positions_to_habitat",
    "read_episodes",
    "write_episodes",
]
