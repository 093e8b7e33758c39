"""Questions about images: frames of a search, and views at which it may stop."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hypernav.core.episode import Episode, PathLeft
from hypernav.core.errors import StartError
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.world import Instance, Simulator
from hypernav.lab.exam.bank import Sheet
from hypernav.lab.exam.questions import NO_IMAGE, ExamQuestion, Kind
from hypernav.search.perception.image_recall import IMAGES_PER_QUESTION
from hypernav.search.perception.local.stand_ins.ground_truth import (
    true_detection,
    true_labels,
    visible_objects,
)
from hypernav.search.perception.local.stand_ins.noisy_detector import distance_to, resembles

_CLEAR_SHARE = 0.002
"""Least share of the image that a thing must cover to be asked for."""
NEAR_M = 2.5  # median depth up to which a goal in a frame is near
_CLOSE_BY_M, _FAR_AWAY_M = 4.0, 10.0
"""True paths, metres, up to which the goal is close by and from which it isn't; else not asked."""
_MOST_SHOWING = 3
"""Largest number of images that show the goal among those of one question."""
_VIEWS = 12
"""Number of things at which a view for these questions is added to those of the search."""


def of_frame(
    sheet: Sheet, step: int, observation: Observation, goals: Sequence[str]
) -> list[ExamQuestion]:
    """Questions for boxes and masks in one frame of the search."""
    truth = true_labels(observation)
    clear = visible_objects(truth, _CLEAR_SHARE)
    any_sign = visible_objects(truth, 0.0)
    found = []
    for text in goals:
        goal = Goal(text)
        seen = [n for n in clear if truth.labels[n].satisfies(goal)]
        if seen:
            true = [true_detection(truth, number) for number in seen]
            depth = observation.depth[true[0].mask]
            away_m = distance_to(true[0], observation)
            near = np.count_nonzero(depth > 0.0) > 0.5 * depth.size and away_m <= NEAR_M
            stratum = "near" if near else "far"
            kinds: tuple[Kind, ...] = ("boxes", "mask") if near else ("boxes",)
            for kind in kinds:
                boxes = tuple(one.box for one in true)
                mask = true[0].mask if kind == "mask" else None
                one = _looked(sheet, step, kind, stratum, goal, observation, boxes=boxes, mask=mask)
                found.append(replace(one, conditions=one.conditions | {"distance_m": away_m}))
        elif not any(truth.labels[n].satisfies(goal) for n in any_sign):
            alike = any(resembles(truth.labels[n], goal) for n in clear)
            stratum = "look-alike" if alike else "absent"
            found.append(_looked(sheet, step, "boxes", stratum, goal, observation))
    return found


def close_by(
    sheet: Sheet, step: int, observation: Observation, goal: Goal, left_m: PathLeft
) -> list[ExamQuestion]:
    """The question whether the goal is likely close by, where the truth is clear."""
    away_m = left_m(*observation.robot.xy)
    if _CLOSE_BY_M < away_m < _FAR_AWAY_M or math.isinf(away_m):
        return []
    is_near = away_m <= _CLOSE_BY_M
    question = _looked(
        sheet, step, "near", "near" if is_near else "far", goal, observation, is_near
    )
    return [replace(question, conditions=question.conditions | {"distance_m": away_m})]


def of_images(
    sheet: Sheet,
    world: Simulator,
    seen: Sequence[Observation],
    goals: Sequence[str],
    rng: np.random.Generator,
) -> list[ExamQuestion]:
    """Questions in which of six images of the building the goal is: in one to three, or in none.

    Images that show the goal, but too small to be asked for, are left out.
    """
    things = [one for one in world.truth.instances if one.label is not None]
    some = rng.permutation(len(things))[:_VIEWS].tolist()
    views = [_stopped_at(world, things[k], rng) for k in some]
    frames = [*seen, *(one for one in views if one is not None)]
    truths = [true_labels(frame) for frame in frames]
    clear = [[t.labels[n] for n in visible_objects(t, _CLEAR_SHARE)] for t in truths]
    any_sign = [[t.labels[n] for n in visible_objects(t, 0.0)] for t in truths]
    found = []
    for text in goals:
        goal = Goal(text)
        numbers = range(len(frames))
        shows = [k for k in numbers if any(label.satisfies(goal) for label in clear[k])]
        lacks = [k for k in numbers if not any(label.satisfies(goal) for label in any_sign[k])]
        for stratum in ("shown", "none"):
            most = min(len(shows), _MOST_SHOWING) if stratum == "shown" else 0
            count = int(rng.integers(1, most + 1)) if most else 0
            others = IMAGES_PER_QUESTION - count
            if (stratum == "shown") != bool(count) or len(lacks) < others:
                continue
            chosen = [*rng.permutation(shows)[:count], *rng.permutation(lacks)[:others]]
            order = [int(k) for k in rng.permutation(chosen)]
            subject = tuple(frames[k] for k in order)
            right = {str(at) for at, k in enumerate(order, 1) if k in shows} or {NO_IMAGE}
            light = float(np.mean([one.rgb.mean() for one in subject])) / 255.0
            found.append(
                ExamQuestion(
                    sheet.question_id(0, "images", stratum, goal),
                    "images",
                    stratum,
                    sheet.scene,
                    goal,
                    subject,
                    right=frozenset(right),
                    conditions={"light": light},
                )
            )
    return found


def of_stops(
    sheet: Sheet, world: Simulator, goals: Sequence[str], rng: np.random.Generator
) -> list[ExamQuestion]:
    """Presence questions at positions where a search may stop, with and without the goal."""
    things = [one for one in world.truth.instances if one.label is not None]
    found, there = [], {"there": 0, "not there": 0, "look-alike": 0}
    for k in rng.permutation(len(things)).tolist()[:30]:
        if min(there.values()) >= 2:
            break
        observation = _stopped_at(world, things[k], rng)
        if observation is None:
            continue
        truth = true_labels(observation)
        shown = [truth.labels[n] for n in visible_objects(truth, 0.0)]
        clear = [truth.labels[n] for n in visible_objects(truth, 10.0 * _CLEAR_SHARE)]
        for text in rng.permutation(list(goals)).tolist():
            goal = Goal(text)
            if any(label.satisfies(goal) for label in clear):
                stratum = "there"
            elif any(label.satisfies(goal) for label in shown):
                continue
            elif any(resembles(label, goal) for label in clear):
                stratum = "look-alike"
            else:
                stratum = "not there"
            if there[stratum] < 2:
                there[stratum] += 1
                is_there = stratum == "there"
                found.append(_looked(sheet, k, "presence", stratum, goal, observation, is_there))
                break
    return found


def _stopped_at(world: Simulator, thing: Instance, rng: np.random.Generator) -> Observation | None:
    """The view of a robot that has stopped at a thing; None if it can't get there."""
    points = world.truth.view_points_of(thing)
    if not len(points):
        return None
    x, y, z = points[int(rng.integers(len(points)))].tolist()
    middle = (np.array(thing.box_min) + np.array(thing.box_max)) / 2.0
    start = Pose2(x, y, math.atan2(middle[1] - y, middle[0] - x))
    goal = Goal(thing.label.category if thing.label else thing.name)
    try:
        return world.reset(Episode(world.truth.name, "stop", goal, start, start_z=z))
    except StartError:
        return None


def _looked(
    sheet: Sheet,
    number: int,
    kind: Kind,
    stratum: str,
    goal: Goal,
    observation: Observation,
    is_so: bool | None = None,
    **true: object,
) -> ExamQuestion:
    """A question about one image; `is_so` is the true answer to yes or no."""
    truth = true_labels(observation)
    right = frozenset[str]() if is_so is None else frozenset({"yes" if is_so else "no"})
    conditions = {
        "clutter": float(len(visible_objects(truth, _CLEAR_SHARE))),
        "light": float(observation.rgb.mean()) / 255.0,
    }
    question = ExamQuestion(
        sheet.question_id(number, kind, stratum, goal),
        kind,
        stratum,
        sheet.scene,
        goal,
        observation,
        right=right,
        conditions=conditions,
    )
    return replace(question, **true)
