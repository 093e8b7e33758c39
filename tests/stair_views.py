"""Stairs out of boxes: up from a room, and down from the edge of its floor; and views of them."""

from box_views import SolidBox, view_of
from hypernav.core.embodiment import BodyConfig, Embodiment
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.stairs.connectors import Connector
from hypernav.search.memory.memory import Memory

TREAD_M, RISE_M, STEPS = 0.28, 0.18, 10
FIRST_X, SIDES_Y = 4.0, (1.4, 2.6)
CLIMBER = Embodiment(body=BodyConfig(max_step_m=0.2))
CAMERA = CLIMBER.camera.intrinsics
MIDDLE_Y = sum(SIDES_Y) / 2.0


def stairs_up(*, storey_m: float = STEPS * RISE_M) -> list[SolidBox]:
    """Steps towards +x from x = 4, between y 1.4 and 2.6, and the floor that they lead to."""
    low, high = SIDES_Y
    steps: list[SolidBox] = [
        ((FIRST_X + k * TREAD_M, low, 0.0), (FIRST_X + (k + 1) * TREAD_M, high, (k + 1) * RISE_M))
        for k in range(STEPS - 1)
    ]
    head = FIRST_X + (STEPS - 1) * TREAD_M
    return [*steps, ((head, -10.0, 0.0), (head + 8.0, 10.0, storey_m))]


def stairwell(*, beyond_m: float = 1.1) -> list[SolidBox]:
    """A floor with a hole without railings, in which stairs lead down towards -x from x = 5.

    Args:
        beyond_m: Width of the hole, between y = 2 and the floor that goes on beyond it, metres.
    """
    far = 2.0 + beyond_m
    steps: list[SolidBox] = [
        (
            (5.0 - (k + 1) * TREAD_M, 2.0, -3.0),
            (5.0 - k * TREAD_M, far, -(k + 1) * RISE_M),
        )
        for k in range(14)
    ]
    return [
        ((-8.0, -8.0, -0.1), (12.0, 2.0, 0.0)),
        ((-8.0, far, -0.1), (12.0, 8.0, 0.0)),
        ((-8.0, 2.0, -0.1), (1.0, far, 0.0)),
        ((5.0, 2.0, -0.1), (12.0, far, 0.0)),
        ((-8.0, -8.0, -3.0), (12.0, 8.0, -2.8)),
        *steps,
    ]


def stairs_down() -> list[SolidBox]:
    """A floor that ends at x = 4, from where steps lead down between walls to one 1.8 m lower."""
    low, high = SIDES_Y
    steps: list[SolidBox] = [
        (
            (FIRST_X + k * TREAD_M, low, -3.0),
            (FIRST_X + (k + 1) * TREAD_M, high, -(k + 1) * RISE_M),
        )
        for k in range(STEPS - 1)
    ]
    return [
        ((-10.0, -10.0, -3.0), (FIRST_X, 10.0, 0.0)),
        *steps,
        ((FIRST_X, -10.0, -3.0), (30.0, 10.0, -STEPS * RISE_M)),
        ((FIRST_X, -10.0, -3.0), (12.0, low, 2.5)),
        ((FIRST_X, high, -3.0), (12.0, 10.0, 2.5)),
    ]


def memory_after(
    boxes: list[SolidBox], *poses: Pose2, robot: Embodiment = CLIMBER, z: float = 0.0
) -> Memory:
    """What a robot that looks for stairs knows after views of boxes, from so high above the floor.

    Args:
        boxes: The boxes.
        poses: Where it takes the views.
        robot: The robot.
        z: Its height, metres.
    """
    height_m = robot.camera.height_m + z
    memory = Memory(MappingConfig(), robot)
    memory.begin_search(sees_stairs=True)
    for pose in poses:
        memory.follow(view_of(boxes, pose, camera=CAMERA, height_m=height_m))
    return memory


def before_stairs(*distances_m: float, yaw: float = 0.0) -> list[Pose2]:
    return [Pose2(FIRST_X - away_m, MIDDLE_Y, yaw) for away_m in distances_m]


def usable(memory: Memory) -> list[Connector]:
    return [one for one in memory.connectors if one.is_usable]


def edge(axis: float, *, x: float = 0.0) -> Connector:
    """Stairs down at a position on the x axis, seen once."""
    return Connector(0, False, (x, 0.0), axis)
