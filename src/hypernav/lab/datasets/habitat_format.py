"""Episodes in Habitat's ObjectNav format, as data, and Habitat's frame.

The models hold a file's values exactly: numbers stay integers or floats, unknown fields are kept,
absent fields stay absent. So a file that is read and written again holds the same JSON values.
OVON's files have the same format with ``children_object_categories``, textual object ids and no
``iou``.

Positions and rotations are Habitat's: y up, quaternions ``[x, y, z, w]``, agents look along -z. A
position ``(x, y, z)`` of Habitat is ``(x, -z, y)`` in the z-up scene frame, as for glTF files. Yaw
is measured from the x axis.
"""

import math
from collections.abc import Sequence
from pathlib import PurePosixPath
from typing import Annotated, Any

import numpy as np
from jaxtyping import Float64
from pydantic import AllowInfNan, BaseModel, ConfigDict, Field, StrictFloat, StrictInt

from hypernav.core.episode import ObjectName
from hypernav.core.errors import EpisodeError
from hypernav.core.geometry.transforms import Pose2, wrap_angle
from hypernav.core.goal import Goal
from hypernav.core.naming.words import is_whole_number
from hypernav.io.parsing import Items
from hypernav.io.reading import back_slashes

LARGEST = 260_000
"""Distance from the origin, metres, up to which single precision tells centimetres: the bound of
all numbers of an episode."""
_Bounds = Field(ge=-LARGEST, le=LARGEST)
Number = Annotated[StrictInt, _Bounds] | Annotated[StrictFloat, AllowInfNan(False), _Bounds]
"""A JSON number within the bounds; 0 and 0.0 stay distinct."""
Position = tuple[Number, Number, Number]
Quaternion = tuple[Number, Number, Number, Number]


def positions_from_habitat(positions: Float64[np.ndarray, "n 3"]) -> Float64[np.ndarray, "n 3"]:
    """Positions in the z-up scene frame, metres."""
    return np.stack([positions[:, 0], -positions[:, 2], positions[:, 1]], axis=1)


def positions_to_habitat(positions: Float64[np.ndarray, "n 3"]) -> Float64[np.ndarray, "n 3"]:
    """Positions in Habitat's y-up frame, metres."""
    return np.stack([positions[:, 0], positions[:, 2], -positions[:, 1]], axis=1)


def pose_from_habitat(position: Sequence[float], rotation: Sequence[float]) -> tuple[Pose2, float]:
    """An agent's pose on the floor.

    Args:
        position: ``[x, y, z]``, Habitat's frame.
        rotation: Quaternion ``[x, y, z, w]``, not necessarily of unit length.

    Returns:
        The pose in the z-up scene frame and the floor's height there.

    Raises:
        EpisodeError: The rotation is zero or looks straight up or down.
    """
    x, y, z, w = rotation
    # The viewing direction (0, 0, -1) rotated by the quaternion, times its squared length.
    forward_x = -2.0 * (x * z + w * y)
    forward_z = -(w * w - x * x - y * y + z * z)
    if math.hypot(forward_x, forward_z) < 1e-6:
        raise EpisodeError(
            f"a rotation must not look straight up or down, got the quaternion {list(rotation)}"
        )
    yaw = wrap_angle(math.atan2(-forward_z, forward_x))
    return Pose2(float(position[0]), -float(position[2]), yaw), float(position[1])


def pose_to_habitat(
    pose: Pose2, floor_z: float
) -> tuple[tuple[float, float, float], tuple[float, float, float, float]]:
    """A pose on the floor as Habitat's position and quaternion ``[x, y, z, w]``."""
    half = (pose.yaw - math.pi / 2.0) / 2.0
    return (pose.x, floor_z, -pose.y), (0.0, math.sin(half), 0.0, math.cos(half))


class _Entry(BaseModel):
    model_config = ConfigDict(frozen=True, extra="allow")


class AgentState(_Entry):
    """Position and orientation of an agent, Habitat's frame.

    Attributes:
        position: Position of its feet, metres.
        rotation: Quaternion ``[x, y, z, w]``; at rest it looks along -z.
    """

    position: Position
    rotation: Quaternion


class ViewPoint(_Entry):
    """A position from which a goal is seen.

    Attributes:
        agent_state: Pose at the position, looking at the goal.
        iou: Share of the image that shows the goal; absent in OVON.
    """

    agent_state: AgentState
    iou: Number | None = None


class ObjectGoal(_Entry):
    """One object that satisfies a goal.

    Attributes:
        object_category: Category of the object.
        object_id: Number in the scene, or text in OVON.
        position: Centre of the object, Habitat's frame.
        view_points: Positions at which it counts as reached.
        object_name: Name in the scene.
    """

    object_category: str
    object_id: StrictInt | str
    position: Position
    view_points: Items[ViewPoint] = Field(default_factory=list)
    object_name: str | None = None

    @property
    def in_scene(self) -> ObjectName:
        """The object's name in its scene; OVON has the name in place of the number."""
        if isinstance(self.object_id, int):
            return ObjectName(self.object_name, self.object_id)
        number = self.object_id.rpartition("_")[2]
        return ObjectName(
            self.object_name or self.object_id, int(number) if is_whole_number(number) else None
        )


class ObjectNavEpisode(_Entry):
    """One start and its goal.

    Attributes:
        episode_id: Unique within its scene.
        scene_id: File of the scene within its data set.
        start_position: Start position, Habitat's frame, metres.
        start_rotation: Start rotation, quaternion ``[x, y, z, w]``.
        object_category: Category to find, as text.
        info: Further values, among them ``geodesic_distance``.
        goals: Usually empty, the goals are in `EpisodeDataset.goals_by_category`; older files have
            them here.
        children_object_categories: Categories that count as well (OVON).
    """

    episode_id: StrictInt | str
    scene_id: str
    start_position: Position
    start_rotation: Quaternion
    object_category: str
    info: dict[str, Any] | None = None
    goals: Items[ObjectGoal] = Field(default_factory=list)
    children_object_categories: list[str] | None = None

    @property
    def goal(self) -> Goal:
        """What to find; Habitat's underscores are spaces."""
        return Goal(self.object_category.replace("_", " "))

    def goals_key(self, category: str | None = None) -> str:
        """Key of this scene's goals of the category in `goals_by_category`."""
        return f"{PurePosixPath(self.scene_id).name}_{category or self.object_category}"


class EpisodeDataset(_Entry):
    """The content of one file.

    Attributes:
        episodes: Episodes in the file's order; empty in the main file of a split whose episodes are
            in files of their own for each scene.
        goals_by_category: All objects of a kind in a scene, by `ObjectNavEpisode.goals_key`.
        category_to_task_category_id: Numbers of the categories.
    """

    episodes: list[ObjectNavEpisode]
    goals_by_category: dict[str, Items[ObjectGoal]] = Field(default_factory=dict)
    category_to_task_category_id: dict[str, int] = Field(default_factory=dict)

    def goals_of(self, episode: ObjectNavEpisode) -> tuple[ObjectGoal, ...]:
        """Every object that counts as found, those of child categories (OVON) included.

        Raises:
            EpisodeError: The file holds no goals for this episode.
        """
        if episode.goals:
            return tuple(episode.goals)
        key = episode.goals_key()
        if key not in self.goals_by_category:
            raise EpisodeError(
                f"episode {episode.episode_id}: no goals for '{episode.object_category}', expected "
                f"the key '{key}' in goals_by_category{back_slashes(episode.scene_id)}"
            )
        keys = [key, *map(episode.goals_key, episode.children_object_categories or [])]
        return tuple(goal for key in keys for goal in self.goals_by_category.get(key, []))

    def view_points_of(self, episode: ObjectNavEpisode) -> Float64[np.ndarray, "n 3"]:
        """All view points of an episode's goals, z-up scene frame, metres.

        Raises:
            EpisodeError: The file holds no goals for this episode.
        """
        positions = [
            point.agent_state.position
            for goal in self.goals_of(episode)
            for point in goal.view_points
        ]
        return positions_from_habitat(np.array(positions, dtype=np.float64).reshape(-1, 3))
