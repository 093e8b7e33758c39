"""Recall: the path to what is remembered and may be the goal, before anything is explored."""

import math
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64

from hypernav.core.events import Event
from hypernav.core.exploring.floors import WayOut
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.search.agents.config import SearchConfig
from hypernav.search.agents.destinations import (
    BESIDE_M,
    Remembered,
    RememberedImage,
    RememberedStairs,
    RememberedThing,
)
from hypernav.search.agents.plan import Plan
from hypernav.search.agents.step import Step
from hypernav.search.mapping.reachable_area import ReachableArea
from hypernav.search.mapping.sight_lines import lines_are_clear
from hypernav.search.mapping.top_down_map import TopDownMap
from hypernav.search.memory.candidate import Candidate
from hypernav.search.memory.floor import Floor, ThingStatus
from hypernav.search.memory.floor_exits import known_floors, routes_from_here
from hypernav.search.memory.goal_words import LIKELY, weights_of_place
from hypernav.search.memory.key_images import KeyImages
from hypernav.search.memory.memory import Memory
from hypernav.search.memory.thing import APART_M, Thing
from hypernav.search.memory.visibility import SHOWN_M
from hypernav.search.perception.image_recall import IMAGES_PER_QUESTION

_PER_STRAIGHT_M = 2.0
"""Length of the path per metre of the straight line to where no free floor is known to lead."""
_ON_FLOOR_M = 0.3
"""Height of a thing's lowest point, metres, from which it stands on something or hangs."""
_UNDER_IT_M = 0.3
"""Distance from such a thing, metres, up to which what it stands on reaches and hides nothing."""

_MOST_ALIKE = 3
"""Number of images that look like the goal to which the robot goes unasked."""
_WORTH_STAIRS = 0.5
"""Chance from which that is so over stairs: more than a thing of the goal's kind alone has."""


def path_to_thing(
    thing: Thing, floor_map: TopDownMap, reach: ReachableArea, robot: Pose2
) -> tuple[tuple[float, float], float]:
    """The reachable position beside a thing, in sight of it, and the length of the path there.

    It lies on a side that the thing was seen from: the map may not show what hides it from others.
    Where there is none beside it, the position is the one farther away with the shortest path on to
    it; where there is none at all, one that the robot has seen it from.

    Args:
        thing: The thing.
        floor_map: Map of its floor.
        reach: What of this floor the robot can reach.
        robot: Pose of the robot.

    Returns:
        The position ``(x, y)``, ``map`` frame, and the length, with what is left from there to a
        thing that is farther away, both in metres.
    """
    for nearest_m, farthest_m in ((0.0, BESIDE_M), (BESIDE_M, SHOWN_M)):
        away_m = _cell_distances_m(thing, reach.grid)
        near = (away_m > nearest_m) & (away_m <= farthest_m) & (reach.reachable > 0)
        rows, columns = np.nonzero(near)
        points = reach.grid.centres_of(np.column_stack([rows, columns]))
        is_clear = _in_sight(thing, floor_map, points)
        if is_clear.any():
            left_m = away_m[rows, columns] if nearest_m > 0.0 else 0.0
            path_m = reach.travel_m[rows, columns] + left_m
            nearest = int(np.where(is_clear, path_m, np.inf).argmin())
            x, y = points[nearest].tolist()
            return (x, y), float(path_m[nearest])
    return path_to_view(thing, reach, robot)


def path_to_view(
    thing: Thing, reach: ReachableArea, robot: Pose2
) -> tuple[tuple[float, float], float]:
    """The position that a thing was seen best from, and the length of the path there, metres."""
    x, y = thing.seen_from
    row, column = reach.grid.cell_of(x, y)
    rows, columns = reach.travel_m.shape
    path_m = np.inf
    if 0 <= row < rows and 0 <= column < columns and reach.reachable[row, column]:
        path_m = float(reach.travel_m[row, column])
    return (x, y), min(path_m, _PER_STRAIGHT_M * robot.distance_to(x, y))


def _in_sight(
    thing: Thing, floor_map: TopDownMap, points: Float64[np.ndarray, "n 2"]
) -> Bool[np.ndarray, " n"]:
    """Whether a thing is in sight from each position, as far as is known."""
    if not len(points):
        return np.zeros(0, dtype=bool)
    inside = np.clip(points, thing.low[:2], thing.high[:2])
    own = _filled(thing, floor_map.grid)
    eye_level = floor_map.eye_level(np.concatenate([points, inside]))
    is_clear = lines_are_clear(eye_level, points, inside, through=own)
    return is_clear & thing.was_seen_from(points)


def _cell_distances_m(thing: Thing, grid: OccupancyGrid) -> Float64[np.ndarray, "rows columns"]:
    """Distance of the middles of a grid's cells from a thing's box, metres."""
    (left, bottom), size = grid.origin, grid.resolution_m
    x = left + (np.arange(grid.cells.shape[1]) + 0.5) * size
    y = bottom + (np.arange(grid.cells.shape[0]) + 0.5) * size
    away_x = np.maximum(np.maximum(thing.low[0] - x, x - thing.high[0]), 0.0)
    away_y = np.maximum(np.maximum(thing.low[1] - y, y - thing.high[1]), 0.0)
    return np.hypot(away_x[None, :], away_y[:, None])


def _filled(thing: Thing, grid: OccupancyGrid) -> Float64[np.ndarray, "n 2"]:
    """Middles of the cells of a thing and of what it stands on, ``(x, y)``, metres."""
    size = grid.resolution_m
    beside_m = size / 2.0 if thing.low[2] < _ON_FLOOR_M else _UNDER_IT_M
    x = np.arange(thing.low[0] - beside_m, thing.high[0] + beside_m + size / 2.0, size)
    y = np.arange(thing.low[1] - beside_m, thing.high[1] + beside_m + size / 2.0, size)
    return np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)


def remembered(step: Step, memory: Memory) -> Remembered | None:
    """Where the memory sends the robot before anything is explored; None if nowhere."""
    return (
        stairs_to_errand(step, memory)
        or recalled(step, memory, LIKELY)
        or seen_in_image(step, memory)
        or stairs_to_recalled(step, memory)
    )


def recalled(step: Step, memory: Memory, least: float) -> RememberedThing | None:
    """The remembered thing with the least path per chance to be the goal; None if none is left.

    Those with a chance below `least` are left out.

    This order has the shortest expected path if chances are independent and paths don't depend on
    where the robot was before.
    """
    best = _best(step, memory, least)
    if best is None:
        return None
    x, y, _ = best.thing.position
    return RememberedThing(
        *best.position,
        reason=f"on the way to a {best.thing.label} seen before",
        face=math.atan2(y - best.position[1], x - best.position[0]),
        thing=best.thing.number,
    )


class _Recalled(NamedTuple):
    """A remembered thing that may be the goal, and the path there.

    Attributes:
        thing: The thing.
        chance: Chance that it is the goal, by all that is remembered.
        position: Position ``(x, y)`` beside it, metres.
        path_m: Length of the path there, metres.
    """

    thing: Thing
    chance: float
    position: tuple[float, float]
    path_m: float


def _best(step: Step, memory: Memory, least: float) -> _Recalled | None:
    """The remembered thing that `recalled` goes to."""
    search, floor = memory.search, memory.floor
    if not step.config.recall:
        return None
    meant = search.errand(floor.things, step.goal)
    likely = [(meant, 1.0)] if meant is not None else _left(floor, step.goal, least)
    if not likely:
        return None
    with step.clock("plan"):
        clearance_m = step.components.planning.clearances_m(step.components.embodiment.body)[0]
        reach = ReachableArea.of(step.grid, step.robot, step.components.mapping, clearance_m)

        def way_to(thing: Thing) -> tuple[tuple[float, float], float]:
            if search.statuses.get(thing.number) is ThingStatus.HIDDEN:
                return path_to_view(thing, reach, step.robot)
            return path_to_thing(thing, floor.map, reach, step.robot)

        reached = [_Recalled(thing, chance, *way_to(thing)) for thing, chance in likely]
    return min(reached, key=lambda one: (one.path_m / one.chance, one.thing.number))


def errand(step: Step, memory: Memory) -> tuple[int, Thing] | None:
    """The one thing that is meant, with the number of its floor.

    Returns:
        None if none is meant, it is gone or was gone to, or stairs that the robot has taken don't
        lead to its floor.
    """
    if all(floor.search.meant is None for floor in memory.floors):
        return None
    goes_up = step.config.recall and step.config.use_stairs
    for number in routes_from_here(memory) if goes_up else [memory.number]:
        floor = memory.floors[number]
        thing = floor.search.errand(floor.things, step.goal)
        if thing is not None:
            return number, thing
    return None


def stairs_to_errand(step: Step, memory: Memory) -> RememberedStairs | None:
    """The stairs to the one thing that is meant, where it is on another floor.

    Returns:
        None if none is meant there, or stairs that the robot has taken don't lead to it.
    """
    meant = errand(step, memory)
    if meant is None or meant[0] == memory.number:
        return None
    number, thing = meant
    way = next(one.way[0] for one in known_floors(memory) if one.number == number)
    reason = f"the {thing.label} that is meant is on another floor: {way.words}"
    return RememberedStairs(*way.xy, reason, way.connector)


def stairs_to_recalled(step: Step, memory: Memory) -> RememberedStairs | None:
    """The stairs to the nearest floor where a remembered thing may be the goal.

    Returns:
        None if there is none, or stairs that the robot has taken don't lead to it.
    """
    found = _recalled_elsewhere(step.goal, memory, step.config)
    if found is None:
        return None
    way, label = found
    reason = f"a {label} was seen on another floor: {way.words}"
    return RememberedStairs(*way.xy, reason, way.connector)


def leaves_for_recalled(goal: Goal, memory: Memory, config: SearchConfig) -> bool:
    """Whether a search would begin by taking stairs to what may be the goal, for want of it here.

    One thing that is meant is gone to straight.
    """
    if any(floor.search.meant is not None for floor in memory.floors):
        return False
    is_elsewhere = _recalled_elsewhere(goal, memory, config) is not None
    return is_elsewhere and not _left(memory.floor, goal, LIKELY)


def _recalled_elsewhere(
    goal: Goal, memory: Memory, config: SearchConfig
) -> tuple[WayOut, str] | None:
    """The stairs to the nearest floor where a remembered thing may be the goal, and its label."""
    for one in known_floors(memory) if config.recall and config.use_stairs else ():
        left = _left(memory.floors[one.number], goal, _WORTH_STAIRS)
        if left:
            return one.way[0], max(left, key=lambda pair: pair[1])[0].label
    return None


def _left(floor: Floor, goal: Goal, least: float) -> list[tuple[Thing, float]]:
    """What is remembered of a floor, may be the goal and was not gone to, with its chances.

    Each has at least the least chance both by its name and by where it is: among many alike, the
    place alone makes none likely.
    """
    search, things = floor.search, floor.things
    left = [
        (thing, chance)
        for thing, chance in things.fitting(goal, besides=search.done)
        if chance >= least and thing.first_search < search.number
    ]
    weights = weights_of_place([thing for thing, _ in left], things.known, goal, floor.map)
    weighed = [
        (thing, min(chance * weight, thing.chance))
        for (thing, chance), weight in zip(left, weights, strict=True)
    ]
    return [pair for pair in weighed if pair[1] >= least]


def seen_in_image(step: Step, memory: Memory) -> RememberedImage | None:
    """The nearest position where a key image was taken in which a chat model sees the goal.

    The model is asked about the images of earlier searches, a few at a time, until it sees it in
    one: those first that look most like it, where a model compares them with its words, else those
    that show most. Where no chat model is asked, it is the nearest position of the few images that
    look like the goal much more than the others. A position from which it is not seen now is not
    gone to again.

    Returns:
        None if no such image is left, or there is no model or memory.
    """
    search, images, recall = memory.search, memory.images, step.components.image_recall
    if not step.config.recall or images is None or not search.lasts:
        return None
    if search.images_to_ask is None:
        search.images_to_ask, search.images_to_visit = _first_images(step, memory, images)
    while recall is not None and not search.images_to_visit and search.images_to_ask:
        asked, search.images_to_ask = (
            search.images_to_ask[:IMAGES_PER_QUESTION],
            search.images_to_ask[IMAGES_PER_QUESTION:],
        )
        shown = [one for number in asked if (one := images.find(number)) is not None]
        with step.clock("global"):
            seen = recall.shown_in([one.rgb for one in shown], step.goal) if shown else ()
        search.images_to_visit = tuple(shown[k].number for k in seen)
    known = [one for number in search.images_to_visit if (one := images.find(number)) is not None]
    if not known:
        return None
    nearest = min(known, key=lambda one: step.robot.distance_to(*one.robot.xy))
    shows = "is in" if _most_to_ask(step) else "may be in"
    return RememberedImage(
        *nearest.robot.xy,
        reason=f"{step.goal.in_sentence} {shows} an image that was taken there before",
        face=nearest.robot.yaw,
        image=nearest.number,
    )


def _first_images(
    step: Step, memory: Memory, images: KeyImages
) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """Numbers of the images to ask a chat model about, in order, and of those to go to unasked."""
    most, ranking, before = _most_to_ask(step), step.components.image_ranking, memory.search.number
    if ranking is None:
        return images.most_telling(memory.number, before=before, most=most), ()
    with step.clock("global"):
        ranked = ranking.ranked(images.earlier(memory.number, before=before), step.goal)
    if most > 0:
        return tuple(one.number for one in ranked[:most]), ()
    return (), tuple(one.number for one in ranked[:_MOST_ALIKE] if one.above >= ranking.least)


def _most_to_ask(step: Step) -> int:
    """Number of images that a chat model may be asked about; 0 where none is."""
    recall = step.components.image_recall
    return 0 if recall is None else recall.config.max_questions * IMAGES_PER_QUESTION


def refutation(memory: Memory, plan: Plan) -> Event | None:
    """What images from the way have shown of the remembered thing; None if it may be the goal."""
    if not isinstance(plan.destination, RememberedThing):
        return None
    thing = memory.floor.things.find(plan.destination.thing)
    if thing is None or thing.is_gone:
        return Event.THING_GONE
    return Event.THING_IS_ANOTHER if thing.number in memory.search.done else None


def may_be_hidden(thing: Thing, step: Step, memory: Memory) -> bool:
    """Whether a thing was not seen yet in this search, nor looked for from where it was seen best.

    It must be what is asked for, as far as its label tells: others are not worth a second way.
    """
    search = memory.search
    is_elsewhere = step.robot.distance_to(*thing.seen_from) >= APART_M
    is_asked_for = thing.fits(step.goal) == 1.0
    was_seen = thing.last_search == search.number
    is_left = thing.number not in search.statuses and not thing.is_gone
    return is_asked_for and is_elsewhere and is_left and not was_seen


def is_nearer(step: Step, memory: Memory, plan: Plan, target: Candidate) -> bool:
    """Whether a remembered thing has less path per chance to be the goal than this candidate.

    That is the one that the robot is going to, or at the start of a search the one that it would go
    to. A candidate that is this thing, or the last chance, is gone to.
    """
    destination = plan.destination
    if target.is_last_chance or memory.search.meant is not None:
        return False
    if destination is None and step.number == 0:
        best = _best(step, memory, LIKELY)
        number, left_m = (None, 0.0) if best is None else (best.thing.number, best.path_m)
    elif isinstance(destination, RememberedThing):
        number, left_m = destination.thing, plan.exploring.route.left_m(step.robot)
    else:
        return False
    there = memory.floor.things.at(*target.area.centre, step.goal)
    chances = {one.number: chance for one, chance in _left(memory.floor, step.goal, 0.0)}
    if number not in chances or any(one.number == number for one in there):
        return False
    worth_m = left_m * target.chance / chances[number]
    if worth_m < target.distance_to(*step.robot.xy):
        return True
    with step.clock("plan"):
        path_m = step.components.navigator.path_m(step.grid, step.robot, target.entry_points)
    return path_m is not None and worth_m < path_m
