"""Exploration: a look around, then from one destination of global perception to the next.

A goal that was seen too far away to be measured, or on another floor, is pursued first.
"""

import math
from dataclasses import replace

import cv2
import numpy as np
from jaxtyping import Float64

from hypernav.core.components.abilities import answers_at_once
from hypernav.core.embodiment import Action
from hypernav.core.events import Event
from hypernav.core.exploring.exploration import Chosen, Destination, StairsDestination
from hypernav.core.exploring.operator_place import PlaceState
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.trace import Mode
from hypernav.search.agents.destinations import (
    BESIDE_M,
    AnyDestination,
    OverStairs,
    Remembered,
    RememberedImage,
    RememberedStairs,
    RememberedThing,
    Sighting,
    arrival_m_of,
    beyond_stairs,
)
from hypernav.search.agents.plan import Climbing, InVain, Plan, patience_of
from hypernav.search.agents.recall import errand, may_be_hidden, recalled, refutation, remembered
from hypernav.search.agents.step import Decision, Phase, Step, turn_towards
from hypernav.search.memory.floor import ThingStatus
from hypernav.search.memory.floor_exits import (
    forget_seen_from_elsewhere,
    seen_from_elsewhere,
    stairs_to_sighting,
    stairs_to_unseen,
    ways_out,
)
from hypernav.search.memory.memory import Memory

_CHOICES_PER_STEP = 4
_AROUND_M = 0.75
"""Radius, metres, within which all must be explored for a destination to count as explored."""
_AT_STAIRS_M = 0.2
"""Distance from the position before stairs, metres, at which the robot turns to them."""
_WORTH_A_TURN_M = 0.3
"""Length of a boundary to the unknown, metres, below which it is noise and worth no turn."""


def pursuing(step: Step, memory: Memory, plan: Plan) -> Plan:
    """The plan that heads for a goal that was seen too far away, or on another floor."""
    if not step.config.pursue_far_sightings or errand(step, memory) is not None:
        return plan
    far, below_or_above = memory.search.evidence.far_position, seen_from_elsewhere(memory)
    if far is not None:
        reason = f"{step.goal.in_sentence} is in sight, too far away to be measured"
        return _towards(Sighting(*far, reason), Event.GOAL_SEEN_FAR_AWAY, step, memory, plan)
    if below_or_above is not None:
        reason = f"{step.goal.in_sentence} was seen there from another floor"
        there = Sighting(*below_or_above, reason)
        return _towards(there, Event.FLOOR_OF_GOAL_REACHED, step, memory, plan)
    return _over_stairs(step, memory, plan) if step.config.use_stairs else plan


def _towards(there: Sighting, event: Event, step: Step, memory: Memory, plan: Plan) -> Plan:
    """The plan that heads for a position of a sighting, unless it was pursued in vain before."""
    config = step.config
    near_m = 2.0 * config.arrival_distance_m
    if any(math.dist(there.xy, other) <= near_m for other in plan.exploring.pursued):
        forget_sighting(memory, there.xy)
        return plan
    if not isinstance(plan.destination, Sighting):
        step.events.append(event)
        plan = plan.explore(patience=patience_of(config))
    return plan.explore(destination=there)


def _over_stairs(step: Step, memory: Memory, plan: Plan) -> Plan:
    """The plan that takes the nearest stairs towards a floor on which the goal was seen."""
    ways = stairs_to_sighting(memory)
    if not ways:
        return plan
    destination = plan.destination
    numbers = [one.connector for one in ways]
    if isinstance(destination, OverStairs) and destination.connector in numbers:
        return plan
    nearest = min(ways, key=lambda one: step.robot.distance_to(*one.xy))
    step.events.append(Event.GOAL_SEEN_ON_OTHER_FLOOR)
    reason = f"{step.goal.in_sentence} was seen on another floor: {nearest.words}"
    there = RememberedStairs(*nearest.xy, reason, nearest.connector)
    return replace(plan, exploring=plan.exploring.towards(there, step.config))


def forget_sighting(memory: Memory, position: tuple[float, float]) -> None:
    """Pursue no more what was seen at a position, metres, too far away or from another floor."""
    search = memory.search
    if search.evidence.far_position == position:
        search.evidence = replace(search.evidence, far_position=None)
    forget_seen_from_elsewhere(memory, position)


def explore(step: Step, memory: Memory, plan: Plan) -> tuple[Decision | Phase, Plan]:
    """Look around; keep a destination until reached, given up or explored; ask for the next.

    A place that the operator sends the robot to comes first.
    """
    config, robot = step.config, step.robot
    decision, plan = go_to(step, memory, plan)
    if decision is not None:
        return decision, plan
    turn = _turn_of_the_look_around(step, memory, plan)
    if turn is not None:
        plan = replace(plan, turns_left=plan.turns_left - 1, last_scan_at=robot.xy)
        return Decision(turn, Mode.LOOK_AROUND, "looking around"), plan
    plan = pursuing(step, memory, replace(plan, turns_left=0))
    turn = _look_across(step, memory, plan)
    if turn is not None:
        return _leading_on(turn, "looking at what is unexplored here", step, plan)
    plan = _without_finished(step, memory, plan)
    plan = _without_expired(plan)
    plan = _reconsidered(step, memory, plan)
    refusal = ""
    for _ in range(_CHOICES_PER_STEP):
        destination = plan.destination
        if destination is None:
            if config.looks == "at-destinations" and not _has_looked(step, plan):
                turns = step.motion.turns_of_a_circle
                return Phase.EXPLORE, replace(plan, turns_left=turns, full_turn=True)
            destination = _next_destination(step, memory)
            if destination is None:
                return Phase.END, _in_vain(refusal, step, plan) if refusal else plan
            if isinstance(destination, Remembered):
                step.events.append(destination.reason)
            plan = replace(plan, exploring=plan.exploring.towards(destination, config))
        away_m = robot.distance_to(*destination.xy)
        if isinstance(destination, OverStairs) and away_m <= _AT_STAIRS_M:
            return _onto_stairs(destination, plan)
        turn = _facing_turn(destination, step)
        if turn is not None:
            return _leading_on(turn, destination.reason, step, plan)
        with step.clock("plan"):
            action, route = step.components.navigator.towards(
                plan.exploring.route, step.grid, robot, np.array([destination.xy])
            )
        plan = plan.explore(route=route)
        if action is None and route.arrived and isinstance(destination, OverStairs):
            return _onto_stairs(destination, plan)
        if action is None:
            event = Event.DESTINATION_REACHED if route.arrived else Event.NO_PATH
        else:
            patience = plan.exploring.patience.after(route.left_m(robot), len(route.actions))
            plan = plan.explore(patience=patience)
            if patience.lasts:
                return _leading_on(action, destination.reason, step, plan)
            event = patience.worn_out
        plan = _ended(event, step, memory, plan)
        if event is not Event.DESTINATION_REACHED:
            x, y = destination.xy
            refusal = f"{event} at ({x:.1f}, {y:.1f}) m: {destination.reason}"
        if action is None and _holds(destination):
            break  # The next move is chosen from another image.
    if not refusal:
        return _decision(Action.TURN_LEFT, "looking where to go next", step, plan), plan
    return _nowhere_to_go(refusal, step, plan)


def _turn_of_the_look_around(step: Step, memory: Memory, plan: Plan) -> Action | None:
    """The next turn of the look around; None if none is left or worthwhile."""
    gaze = step.components.gaze
    if plan.turns_left == 0:
        return None
    if plan.full_turn or gaze is None:
        return Action.TURN_LEFT
    return gaze.worthwhile_turn(step.exploration_grid(memory), step.robot, memory.search.looked)


def _next_destination(step: Step, memory: Memory) -> AnyDestination | None:
    """What is remembered, what is unexplored, what was seen and is hardly the goal, the stairs."""
    destination = remembered(step, memory) or _explored(step, memory)
    destination = destination or recalled(step, memory, 0.0)
    if destination is None:
        memory.floor.was_explored = True
        memory.search.is_explored = not _may_look_again(step, memory)
    return destination or _stairs_out(step, memory)


def _explored(step: Step, memory: Memory) -> Chosen | None:
    """The explorer's next destination; where all is known, what this search has not looked at.

    Stairs to what nobody has seen come before that; the robot comes back for it.
    """
    search, explorer = memory.search, step.components.explorer
    with step.clock("global"):
        destination = explorer.next_destination(step.view(memory))
        leads_on = step.config.use_stairs and bool(stairs_to_unseen(memory))
        if destination is None and _may_look_again(step, memory) and not leads_on:
            search.revisits = True
            step.events.append(Event.LOOKING_AGAIN)
            destination = explorer.next_destination(step.view(memory))
    return destination


def _may_look_again(step: Step, memory: Memory) -> bool:
    """Whether this search knows parts of the floor from earlier ones alone, and leaves them out."""
    search = memory.search
    return step.config.recall and search.coverage is not None and not search.revisits


def _stairs_out(step: Step, memory: Memory) -> StairsDestination | None:
    """The nearest stairs towards what is unseen, where the explorer has nothing left to offer."""
    known = ways_out(memory) if step.config.use_stairs else []
    nearest = min(known, key=lambda one: step.robot.distance_to(*one.xy), default=None)
    if nearest is None:
        return None
    reason = f"nothing is left to explore on this floor: {nearest.words}"
    return StairsDestination(*nearest.xy, reason, nearest.connector)


def _leading_on(action: Action, reason: str, step: Step, plan: Plan) -> tuple[Decision, Plan]:
    """The decision for an action towards the destination."""
    plan = plan.explore(age=plan.exploring.age + 1, in_vain=None)
    return _decision(action, reason, step, plan), plan


def _in_vain(why: str, step: Step, plan: Plan) -> Plan:
    """The plan after one more step in which no destination led on."""
    before = plan.exploring.in_vain
    turns = before.turns + 1 if before is not None and before.is_at(step.robot) else 1
    return plan.explore(in_vain=InVain(step.robot.xy, turns, why))


def _nowhere_to_go(refusal: str, step: Step, plan: Plan) -> tuple[Decision | Phase, Plan]:
    """A turn, to ask the explorer from another heading; after a circle of them, nothing is left."""
    step.events.append(Event.NOWHERE_TO_GO)
    plan = _in_vain(refusal, step, plan)
    vain = plan.exploring.in_vain
    if step.config.end_when_explored and vain and vain.turns > step.motion.turns_of_a_circle:
        return Phase.END, plan
    return _decision(Action.TURN_LEFT, f"{refusal}; looking again", step, plan), plan


def _decision(action: Action, reason: str, step: Step, plan: Plan) -> Decision:
    mode = Mode.RECALL if isinstance(plan.destination, Remembered) else Mode.EXPLORE
    return Decision(action, mode, reason, plan.exploring.route.remaining(step.robot))


def _has_looked(step: Step, plan: Plan) -> bool:
    """Whether the latest turn around was here."""
    position, near_m = plan.last_scan_at, step.config.arrival_distance_m
    return position is not None and step.robot.distance_to(*position) < near_m


def _without_finished(step: Step, memory: Memory, plan: Plan) -> Plan:
    """The plan without a destination that is reached, or around which all is explored."""
    destination, config = plan.destination, step.config
    if destination is None or isinstance(destination, OverStairs):
        return plan
    refuted = refutation(memory, plan)
    if refuted is not None:
        return _ended(refuted, step, memory, plan)
    if step.robot.distance_to(*destination.xy) < arrival_m_of(destination, config):
        if _facing_turn(destination, step) is None:
            return _ended(Event.DESTINATION_REACHED, step, memory, plan)
    elif (
        config.drop_explored
        and isinstance(destination, Destination)
        and not destination.holds
        and len(unexplored_boundary(step.exploration_grid(memory), destination.xy, _AROUND_M)) == 0
    ):
        return _ended(Event.DESTINATION_EXPLORED, step, memory, plan)
    return plan


def _without_expired(plan: Plan) -> Plan:
    """The plan without a destination whose ``most_steps`` have passed: the explorer is asked again.

    It does not count as visited, and patience goes on if the answer is the same as before.
    """
    destination = plan.destination
    if not isinstance(destination, Destination) or destination.most_steps is None:
        return plan
    plan = plan.explore(unasked=plan.exploring.unasked + 1)
    if plan.exploring.unasked < destination.most_steps:
        return plan
    return plan.explore(expired=destination, destination=None)


def _reconsidered(step: Step, memory: Memory, plan: Plan) -> Plan:
    """The plan with the destination that the explorer, asked again on the way, names instead.

    A destination that was left for another is not taken again on the way: the robot would go to
    and fro.
    """
    destination, config, explorer = plan.destination, step.config, step.components.explorer
    if (
        config.reconsider_steps is None
        or config.looks == "at-destinations"
        or not isinstance(destination, Chosen)
        or not answers_at_once(explorer)
    ):
        return plan
    plan = plan.explore(unasked=plan.exploring.unasked + 1)
    if plan.exploring.unasked < config.reconsider_steps:
        return plan
    plan = plan.explore(unasked=0)
    with step.clock("global"):
        other = explorer.next_destination(step.view(memory))
    if other is None:
        return plan
    plan = plan.explore(offered=other.blocks, insight=other.insight or plan.exploring.insight)
    near_m = 2.0 * config.arrival_distance_m
    known = (destination.xy, *plan.exploring.left)
    is_near = math.dist(other.xy, destination.xy) <= near_m
    same = _renamed(destination, other) if is_near else None
    if same is not None:
        return plan.explore(destination=same)
    if any(math.dist(other.xy, one) <= near_m for one in known):
        return plan
    step.events.append(Event.DESTINATION_CHANGED)
    left = (*plan.exploring.left, destination.xy)
    return replace(plan, exploring=plan.exploring.towards(other, config, left=left))


def _ended(event: Event, step: Step, memory: Memory, plan: Plan) -> Plan:
    """The plan without its destination, whose end the memory keeps; each kind has its own."""
    search = memory.search
    if plan.destination is None:
        return plan
    step.events.append(event)
    match plan.destination:
        case StairsDestination(connector=number) | RememberedStairs(connector=number):
            if event is Event.NO_PATH:
                search.unreached.add(number)
            else:
                memory.give_up(number)
        case Sighting(xy=position):
            forget_sighting(memory, position)
            plan = plan.explore(pursued=(*plan.exploring.pursued, position))
        case RememberedThing(thing=number):
            _end_at_thing(number, step, memory)
        case RememberedImage(image=number):
            left = (one for one in search.images_to_visit if one != number)
            search.images_to_visit = tuple(left)
        case Destination(face=face, holds=holds, xy=position):
            if face is None or not holds:  # a turn on the spot is no visit
                search.visits.append(position)
    return plan.explore(destination=None, age=0)


def _end_at_thing(number: int, step: Step, memory: Memory) -> None:
    """Note that the robot has gone to a remembered thing, or has to once more."""
    search, thing = memory.search, memory.floor.things.find(number)
    if thing is not None and may_be_hidden(thing, step, memory):
        step.events.append(Event.THING_NOT_IN_SIGHT)
        search.statuses[number] = ThingStatus.HIDDEN
        return
    search.statuses[number] = ThingStatus.DONE
    if thing is None or thing.fits(step.goal) == 1.0:
        search.revisits = True  # it may have been moved, and not far


def _onto_stairs(destination: OverStairs, plan: Plan) -> tuple[Phase, Plan]:
    climbing = Climbing(destination.connector, then=beyond_stairs(destination))
    return Phase.CLIMB, replace(plan.explore(destination=None), climbing=climbing)


def _renamed(destination: Chosen, other: Chosen) -> Chosen | None:
    """A destination that was chosen again, with the new reason; None if the other one is new.

    Blocks are numbered anew, so the reason of before would name another one.
    """
    match destination, other:
        case Destination(), Destination():
            return replace(destination, reason=other.reason, face=other.face)
        case StairsDestination(), StairsDestination() if destination.connector == other.connector:
            return replace(destination, reason=other.reason)
    return None


def _holds(destination: AnyDestination) -> bool:
    """Whether a destination stays valid whatever the map shows on the way."""
    return isinstance(destination, Remembered) or (
        isinstance(destination, Destination) and destination.holds
    )


def _facing_turn(destination: AnyDestination, step: Step) -> Action | None:
    """At a destination with a heading, the turn towards it; None if the robot faces it already."""
    robot, arrival_m = step.robot, arrival_m_of(destination, step.config)
    if isinstance(destination, OverStairs | Sighting) or destination.face is None:
        return None
    if robot.distance_to(*destination.xy) >= arrival_m:
        return None
    ahead = (robot.x + math.cos(destination.face), robot.y + math.sin(destination.face))
    return turn_towards(robot, ahead, step.motion)


def _look_across(step: Step, memory: Memory, plan: Plan) -> Action | None:
    """At the destination, the turn towards what is still unexplored around it.

    A robot that comes to a door sideways has not yet looked through it. At an edge of the floor
    it turns to that alone.
    """
    destination, config, robot = plan.destination, step.config, step.robot
    if (
        not config.look_across_boundary
        or not isinstance(destination, Destination)
        or destination.holds
        or destination.face is not None
        or plan.exploring.age >= config.endurance_steps
        or robot.distance_to(*destination.xy) >= arrival_m_of(destination, config)
    ):
        return None
    grid = step.exploration_grid(memory)
    if step.components.gaze is not None:
        return step.components.gaze.worthwhile_turn(grid, robot, memory.search.looked)
    points = unexplored_boundary(grid, destination.xy, _AROUND_M)
    if len(points) * grid.resolution_m < _WORTH_A_TURN_M:
        return None
    away = points - np.array(robot.xy)
    ahead = np.array(robot.xy) + (away / np.linalg.norm(away, axis=1, keepdims=True)).mean(0)
    return turn_towards(robot, (float(ahead[0]), float(ahead[1])), step.motion)


def unexplored_boundary(
    grid: OccupancyGrid, position: tuple[float, float], radius_m: float
) -> Float64[np.ndarray, "n 2"]:
    """Centres ``(x, y)`` of free cells beside unknown ones around a position, all in metres."""
    row, column = grid.cell_of(*position)
    reach = math.ceil(radius_m / grid.resolution_m)
    bottom, left = max(row - reach, 0), max(column - reach, 0)
    around = grid.cells[bottom : max(row + reach + 1, 0), left : max(column + reach + 1, 0)]
    beside_unknown = cv2.dilate((around == Cell.UNKNOWN).view(np.uint8), np.ones((3, 3)))
    return grid.centres_of(
        np.argwhere((around == Cell.FREE) & (beside_unknown > 0)) + np.array([bottom, left])
    )


def go_to(step: Step, memory: Memory, plan: Plan) -> tuple[Decision | None, Plan]:
    """Drive to the place that the operator chose; there, look at what is unseen around it.

    The end is named as an event. Other floors have no path.

    Returns:
        No decision if there is no such place, or the way there has ended; then the search goes on.
    """
    sent, navigator, robot = plan.sent, step.components.navigator, step.robot
    if sent is None:
        return None, plan
    nearest, state = None, PlaceState.NO_PATH
    with step.clock("plan"):
        if sent.place.floor == memory.number + 1:
            nearest = navigator.nearest_known(step.grid, robot, sent.place.xy, BESIDE_M)
        if nearest is not None:
            targets = np.array([nearest])
            action, route = navigator.towards(sent.route, step.grid, robot, targets)
            patience = sent.patience.after(route.left_m(robot), len(route.actions))
            if action is not None and patience.lasts:
                reason = "going to the place that the operator chose"
                decision = Decision(action, Mode.EXPLORE, reason, route.remaining(robot))
                return decision, replace(plan, sent=replace(sent, patience=patience, route=route))
            if action is not None:
                state = PlaceState.NO_PROGRESS
            elif route.arrived:
                state = PlaceState.REACHED
    step.events.append(state.event)
    plan = replace(plan, sent=None)
    if state is PlaceState.REACHED:
        plan = replace(plan, turns_left=step.motion.turns_of_a_circle, full_turn=False)
    return None, plan
