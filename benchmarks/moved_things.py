"""Buildings in which things have been moved, for benchmarks of memories.

Only what people move by hand: what stands on the floor with nothing on it goes to another spot that
leaves the way free, and what stands on furniture changes places with something like it.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from jaxtyping import Float64

from hypernav.core.world import Instance, Walkable
from hypernav.simulator.worlds.scenes.scene import Scene

_LARGEST_M = 1.0
"""Side of the largest thing that is moved, metres."""
_FREE_M = 0.4
"""Walkable floor around a new spot, metres."""
_AT_ROBOT_M = 1.0
"""Distance from the robot within which nothing is put down, metres."""
_LEAST_M = 1.5
"""Least way of a thing that is moved, metres."""
_ALIKE_M = 0.15
"""Difference between the sides of two things up to which they change places, metres."""
_TRIES = 200


def with_moved_things(
    scene: Scene,
    walkable: Walkable,
    share: float,
    robot: tuple[float, float],
    rng: np.random.Generator,
) -> tuple[Scene, set[int]]:
    """A building after some of its things were moved.

    Args:
        scene: The building before.
        walkable: Its walkable surface.
        share: Share of its labelled things that are moved, at most all that can be.
        robot: Position ``(x, y)`` of the robot, scene frame, metres.
        rng: Source of randomness.

    Returns:
        The building, and the numbers of the things that were moved.
    """
    things = [one for one in scene.instances if one.label is not None]
    light = [one for one in things if _is_light(one)]
    shifts = dict[int, Float64[np.ndarray, "3"]]()
    for k in rng.permutation(len(light)).tolist():
        if len(shifts) >= share * len(things):
            break
        if light[k].id not in shifts:
            shifts |= dict(_moved(light[k], light, things, walkable, robot, rng, shifts))
    vertices, instances = scene.vertices.copy(), list(scene.instances)
    for number, shift in shifts.items():
        one = instances[number]
        vertices[np.unique(scene.faces[scene.face_instance == number])] += shift.astype(np.float32)
        x0, y0, z0 = (np.array(one.box_min) + shift).tolist()
        x1, y1, z1 = (np.array(one.box_max) + shift).tolist()
        instances[number] = replace(one, box_min=(x0, y0, z0), box_max=(x1, y1, z1))
    moved = replace(scene, vertices=vertices, instances=tuple(instances), navmesh=None, cache=None)
    return moved, set(shifts)


def movable_names(scene: Scene) -> list[str]:
    """The categories of which there are things that may be moved, in alphabetical order."""
    return sorted({one.label.category for one in scene.instances if one.label and _is_light(one)})


def _moved(
    one: Instance,
    light: list[Instance],
    things: list[Instance],
    walkable: Walkable,
    robot: tuple[float, float],
    rng: np.random.Generator,
    taken: dict[int, Float64[np.ndarray, "3"]],
) -> Iterator[tuple[int, Float64[np.ndarray, "3"]]]:
    """Numbers and ways of what moves with a thing; nothing if there is no spot for it."""
    if _stands_on_floor(one):
        is_bare = not any(_is_on(other, one) for other in things)
        spot = _spot_on_floor(one, walkable, robot, rng) if is_bare else None
        if spot is not None:
            yield one.id, np.append(spot - _middle(one)[:2], 0.0)
        return
    if not any(_is_on(one, other) for other in things):
        return  # it hangs
    for k in rng.permutation(len(light)).tolist():
        other = light[k]
        is_alike = np.abs(_size(one)[:2] - _size(other)[:2]).max() <= _ALIKE_M
        way = _bottom(other) - _bottom(one)
        if (
            is_alike
            and other.id not in taken
            and not _stands_on_floor(other)
            and np.linalg.norm(way) >= _LEAST_M
            and any(_is_on(other, under) for under in things)
        ):
            yield one.id, way
            yield other.id, -way
            return


def _spot_on_floor(
    one: Instance,
    walkable: Walkable,
    robot: tuple[float, float],
    rng: np.random.Generator,
) -> Float64[np.ndarray, "2"] | None:
    middle, half = _middle(one)[:2], _size(one)[:2] / 2.0 + _FREE_M
    steps = [np.arange(-side, side + 0.05, 0.1) for side in half]
    around = np.stack(np.meshgrid(*steps), axis=-1).reshape(-1, 2)
    for _ in range(_TRIES):
        spot = middle + rng.uniform(-6.0, 6.0, 2)
        far_enough = np.linalg.norm(spot - middle) >= _LEAST_M
        if not far_enough or np.linalg.norm(spot - np.array(robot)) < _AT_ROBOT_M + half.max():
            continue
        if all(walkable.is_standable(x, y) for x, y in (spot + around).tolist()):
            return spot
    return None


def _is_light(one: Instance) -> bool:
    return bool(_size(one).max() <= _LARGEST_M)


def _stands_on_floor(one: Instance) -> bool:
    return one.box_min[2] < 0.03


def _is_on(one: Instance, other: Instance) -> bool:
    """Whether a thing stands on another."""
    x, y, z = _bottom(one)
    (x0, y0, _), (x1, y1, top) = other.box_min, other.box_max
    return one is not other and x0 <= x <= x1 and y0 <= y <= y1 and abs(z - top) <= 0.03


def _middle(one: Instance) -> Float64[np.ndarray, "3"]:
    return (np.array(one.box_min) + np.array(one.box_max)) / 2.0


def _bottom(one: Instance) -> Float64[np.ndarray, "3"]:
    x, y, _ = _middle(one)
    return np.array([x, y, one.box_min[2]])


def _size(one: Instance) -> Float64[np.ndarray, "3"]:
    return np.array(one.box_max) - np.array(one.box_min)
