"""The path over stairs to another floor."""

from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool

from hypernav.core.embodiment import Action
from hypernav.core.events import Event
from hypernav.core.trace import Mode
from hypernav.search.agents.get_free import closed_turns
from hypernav.search.agents.plan import Climbing, Plan
from hypernav.search.agents.step import Decision, Phase, Step, turn_towards
from hypernav.search.mapping.elevation_map import LEVEL_M, POSE_ERROR_M, Ground
from hypernav.search.mapping.stairs.connectors import Connector, Passage
from hypernav.search.mapping.stairs.flights import (
    ahead_of,
    along_walls,
    first_ahead,
    first_flight,
    flight_down,
    flight_from,
    flight_underfoot,
    from_front,
    landing_z,
    on_flight,
    stairs_ahead,
)
from hypernav.search.memory.floor_exits import BEFORE_M
from hypernav.search.memory.memory import Memory
from hypernav.search.planning.bump_sensor import is_cut_short
from hypernav.search.planning.stair_steps import step_over_ground

_PATIENCES = 1.5
"""Patience with stairs on which the robot comes no farther up or down, in patiences with a
destination (`SearchConfig.endurance_steps`)."""
_PATIENCES_BEFORE = 0.5
"""The same for the path onto them: that takes up to ten steps where the robot touches nothing."""
_SAME_SHARE = 0.5
"""Distance below which they may be, by the length of a step."""

_TO_AND_FRO = {Action.TURN_LEFT, Action.TURN_RIGHT}
"""Two turns of which one undoes the other."""


@dataclass(frozen=True, eq=False)
class _Stairs:
    """The stairs around the robot, in the direction in which it goes.

    Attributes:
        ground: Ground around the robot.
        goes_up: Whether it goes up.
        on_slope: Whether its latest step led up or down, and nothing stops it.
        level_z: Height of the level ground around it, as it looks, metres.
        z: Height that it goes by, metres: on a slope its own.
    """

    ground: Ground
    goes_up: bool
    on_slope: bool
    level_z: float
    z: float


def climb(step: Step, memory: Memory, plan: Plan) -> tuple[Decision | Phase, Plan]:
    """Go over a connector and on to the next floor; turn back where it does not lead there.

    The robot counts as on the floor that it came from until the memory says otherwise.
    """
    climbing, footing = plan.climbing, memory.footing
    if climbing is None:
        return Phase.EXPLORE, plan
    connector = _connector(memory, climbing)
    touching = _touches(step, plan, climbing)
    is_in_front = climbing.from_front or (touching and not footing.is_off_floor)
    climbing = replace(climbing, touching=touching, from_front=is_in_front)
    goes_up = connector.goes_up != climbing.is_back
    climbing = climbing.after_step(footing.z if goes_up else -footing.z)
    patience = _PATIENCES if footing.is_off_floor else _PATIENCES_BEFORE
    if climbing.steps > patience * step.config.endurance_steps:
        return _given_up(step, memory, plan, climbing)
    has_turned = climbing.turned >= step.motion.turns_of_a_circle
    if (climbing.is_back or has_turned) and not footing.is_off_floor:
        return _given_up(step, memory, plan, climbing)
    stairs = _around(step, memory, climbing, goes_up=goes_up)
    flight = _flight(step, memory, climbing, stairs, connector)
    climbing = replace(climbing, flight=flight)
    with step.clock("plan"):
        closed = closed_turns(step, plan)
        action, leads_on = _next_action(step, memory, climbing, stairs, flight, closed)
    words = f"on the stairs {_where_to(memory, climbing, goes_up=stairs.goes_up)}"
    if action is Action.MOVE_FORWARD:
        came_by = (*climbing.came_by, (*step.robot.xy, footing.z))
        looked = _looked(step, climbing)
        climbing = replace(climbing, turned=0, turning=None, looked=looked, came_by=came_by)
        return Decision(action, Mode.CLIMB, words), replace(plan, climbing=climbing)
    if action is not None:
        return _turned(action, words, climbing, plan)
    turn = Action.TURN_LEFT
    if not (footing.is_off_floor or leads_on):
        turn = turn_towards(step.robot, (flight or connector).beyond, step.motion)
    if turn is None or has_turned:
        return _given_up(step, memory, plan, climbing)
    climbing = replace(climbing, turned=climbing.turned + 1)
    return _turned(turn, f"{words}, looking where they lead on", climbing, plan)


def _turned(turn: Action, words: str, climbing: Climbing, plan: Plan) -> tuple[Decision, Plan]:
    """A turn on the spot: once it would undo the one before, all until the next step go one way."""
    turning = climbing.turning
    if turning is None and plan.ordered is not None and {turn, plan.ordered[1]} == _TO_AND_FRO:
        turning = turn
    decision = Decision(turning or turn, Mode.CLIMB, words)
    return decision, replace(plan, climbing=replace(climbing, turning=turning))


def _connector(memory: Memory, climbing: Climbing) -> Connector:
    """The connector that the robot takes, along the walls around its end."""
    connector = memory.connectors[climbing.connector]
    return along_walls(connector, memory.floors[connector.floor].map.grid)


def _around(step: Step, memory: Memory, climbing: Climbing, *, goes_up: bool) -> _Stairs:
    ground = memory.ground_around(step.robot.xy, down=not goes_up, under=not goes_up)
    footing = memory.footing
    on_slope = footing.is_off_floor and footing.is_on_slope
    on_slope = on_slope and not _is_lost(step, memory, climbing)
    level_z = landing_z(ground, step.robot, footing.z)
    return _Stairs(ground, goes_up, on_slope, level_z, footing.z if on_slope else level_z)


def _flight(
    step: Step,
    memory: Memory,
    climbing: Climbing,
    stairs: _Stairs,
    connector: Connector,
) -> Connector | None:
    """The flight that the robot is on or goes to, as far as it is known now."""
    ground, robot = stairs.ground, step.robot
    first, known = flight_from(connector, goes_up=stairs.goes_up), climbing.flight
    if not memory.footing.is_off_floor:  # stairs that it came by have the axis of its last step
        is_lost = not climbing.from_front and _was_here(step, memory, climbing)
        is_known = connector.passage is Passage.UNTRIED and not is_lost
        return first_flight(ground, first, memory.floor.z) if is_known else None
    if stairs.goes_up:
        return known
    if not stairs.on_slope:
        known = None if _is_lost(step, memory, climbing) else known
        return flight_down(ground, robot, stairs.z, known, first)
    if memory.footing.rose_m < -LEVEL_M and climbing.came_by:
        way = (*climbing.came_by, (*robot.xy, memory.footing.z))
        return flight_underfoot(known, first, way, robot)
    return known


def _next_action(
    step: Step,
    memory: Memory,
    climbing: Climbing,
    stairs: _Stairs,
    flight: Connector | None,
    closed: Collection[int],
) -> tuple[Action | None, bool]:
    """The next turn or step on the path over stairs, and whether they are seen to lead on."""
    action, leads_on = None, False
    for ground, to in _ways_on(step, memory, climbing, stairs, flight):
        leads_on = bool(to.any())
        action = step_over_ground(
            ground, step.robot, to, step.motion, touching=climbing.touching, closed=closed
        )
        if action is not None:
            break
    return action, leads_on


def _ways_on(
    step: Step, memory: Memory, climbing: Climbing, stairs: _Stairs, flight: Connector | None
) -> Iterator[tuple[Ground, Bool[np.ndarray, "rows columns"]]]:
    """The ground along a flight, and the part of it to go to, the best first; some are empty.

    That is the next part of the stairs, on this flight or, as it may be another one, on any. Where
    these end or the robot has looked all around in vain, it is level ground beyond the landing.
    """
    footing, goes_up, on_slope = memory.footing, stairs.goes_up, stairs.on_slope
    has_looked = climbing.turned >= step.motion.turns_of_a_circle
    for one in (None,) if flight is None else (flight, None):
        ground, beyond = _level_beyond(step, memory, climbing, stairs, one)
        if has_looked or (footing.is_storey_away and not on_slope and beyond.any()):
            yield ground, beyond
            continue
        here = step.robot, stairs.z, one
        yield ground, stairs_ahead(ground, *here, goes_up=goes_up, on_slope=on_slope)
        if one is None and footing.is_off_floor:
            yield ground, beyond


def _level_beyond(
    step: Step, memory: Memory, climbing: Climbing, stairs: _Stairs, flight: Connector | None
) -> tuple[Ground, Bool[np.ndarray, "rows columns"]]:
    """The ground along a flight, and the level part of it that is clear of the stairs.

    While the robot looks around, only what is ahead counts.
    """
    robot, circle = step.robot, step.motion.turns_of_a_circle
    ground = on_flight(stairs.ground, robot, stairs.z, flight, goes_up=stairs.goes_up)
    if flight is not None and climbing.from_front and not memory.footing.is_off_floor:
        ground = from_front(ground, robot, flight)
    looked = _looked(step, climbing)
    beyond = memory.footing.way_on(ground, stairs.level_z, BEFORE_M, looked)
    ahead = ahead_of if 0 < climbing.turned < circle else first_ahead
    return ground, ahead(ground, robot, beyond)


def _is_lost(step: Step, memory: Memory, climbing: Climbing) -> bool:
    """Whether something stops the robot, it is where it was before, or has looked around for long.

    Heights err by a few centimetres: either end of a landing may seem lower than the other.
    """
    has_looked = climbing.turned > step.motion.turns_of_a_circle // 4
    return climbing.touching or has_looked or _was_here(step, memory, climbing)


def _was_here(step: Step, memory: Memory, climbing: Climbing) -> bool:
    """Whether the robot made a step of this climb from where it is now."""
    near_m = _SAME_SHARE * step.motion.forward_m
    return any(
        step.robot.distance_to(x, y) < near_m and abs(memory.footing.z - z) < POSE_ERROR_M
        for x, y, z in climbing.came_by
    )


def _looked(step: Step, climbing: Climbing) -> tuple[tuple[float, float], ...]:
    """Where the robot has looked for stairs on landings, this place included if it turns here."""
    return (*climbing.looked, step.robot.xy) if climbing.turned else climbing.looked


def _where_to(memory: Memory, climbing: Climbing, *, goes_up: bool) -> str:
    """Where the stairs lead: to a floor that the robot knows, or up or down."""
    here, other = memory.number, memory.connectors[climbing.connector].other_floor
    if climbing.is_back:
        return f"back to floor {here + 1}"
    if other is None or other == here:  # not known, or to another level of this floor
        return "up" if goes_up else "down"
    return f"to floor {other + 1}"


def _touches(step: Step, plan: Plan, climbing: Climbing) -> bool:
    """Whether the robot has bumped into something and has not got away from it yet."""
    if plan.ordered is None or plan.ordered[1] is not Action.MOVE_FORWARD:
        return climbing.touching
    return is_cut_short(plan.ordered, step.robot, step.motion)


def _given_up(
    step: Step, memory: Memory, plan: Plan, climbing: Climbing
) -> tuple[Decision | Phase, Plan]:
    """Turn back; end the attempt on level ground, or where the robot has turned back already.

    A storey away the robot has come to another floor, though it may hardly move there.
    """
    if memory.footing.is_off_floor and not (memory.on_stairs or climbing.is_back):
        memory.reached_level(climbing.connector)
        step.events.append(Event.LEVEL_REACHED)
        return Phase.EXPLORE, replace(plan, climbing=None)
    if not climbing.is_back and memory.try_accept_new_floor():
        decision = Decision(Action.TURN_LEFT, Mode.CLIMB, "the stairs end here")
        return decision, replace(plan, climbing=climbing)
    memory.give_up(climbing.connector)
    if climbing.is_back or not memory.on_stairs:
        step.events.append(Event.STAIRS_GIVEN_UP)
        return Phase.EXPLORE, replace(plan, climbing=None)
    step.events.append(Event.TURNING_BACK)
    connector = _connector(memory, climbing)
    flight = flight_from(connector, goes_up=not connector.goes_up)
    back = Climbing(climbing.connector, is_back=True, flight=flight)
    decision = Decision(Action.TURN_LEFT, Mode.CLIMB, "the stairs lead nowhere, turning back")
    return decision, replace(plan, climbing=back)
