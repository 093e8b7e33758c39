"""The way over stairs to another floor."""

from dataclasses import replace

from hypernav.agents.plan import Climbing, Plan
from hypernav.agents.step import Decision, Phase, Step, turn_towards
from hypernav.core.actions import Action
from hypernav.core.trace import Mode
from hypernav.mapping.memory.connectors import Passage
from hypernav.mapping.memory.flights import (
    first_ahead,
    flight_down,
    flight_from,
    landing_z,
    on_flight,
    stairs_ahead,
)
from hypernav.mapping.memory.memory import Memory
from hypernav.planning.stair_steps import step_over_ground

_OFF_STAIRS_M = 0.8
"""Length of the way on from the head or foot of stairs, metres, before it is clear of them."""
_PATIENCES = 2
"""Patience with one connector, in patiences with a destination (`SearchConfig.endurance_steps`)."""
_MOVED_SHARE = 0.5
"""Share of a step below which the robot has bumped into something."""


def climb(step: Step, memory: Memory, plan: Plan) -> tuple[Decision | Phase, Plan]:
    """Go over a connector and on to the next floor; turn back where it does not lead there.

    The robot counts as on the floor that it came from until the memory says otherwise.
    """
    climbing = plan.climbing
    if climbing is None:
        return Phase.LOOK_AROUND, plan
    connector = memory.connectors[climbing.connector]
    climbing = replace(climbing, steps=climbing.steps + 1, touching=_touches(step, plan, climbing))
    if climbing.steps > _PATIENCES * step.config.endurance_steps:
        return _given_up(step, memory, plan, climbing)
    if climbing.is_back and not memory.is_off_floor:
        return _given_up(step, memory, plan, climbing)
    goes_up = connector.goes_up != climbing.is_back
    ground = memory.ground_around(step.robot.xy, down=not goes_up)
    is_lost = climbing.touching or climbing.turned > step.motion.turns_of_a_circle // 4
    on_slope = memory.is_off_floor and memory.is_on_slope and not is_lost
    level_z = landing_z(ground, step.robot, memory.z)
    here = step.robot, memory.z if on_slope else level_z
    first, flight = flight_from(connector, goes_up=goes_up), climbing.flight
    if not memory.is_off_floor:  # stairs that it came by have the axis of its last step
        flight = first if connector.passage is Passage.UNTRIED else None
    elif not goes_up and not on_slope:
        flight = flight_down(ground, *here, None if is_lost else flight, first)
    climbing = replace(climbing, flight=flight)
    ground = on_flight(ground, *here, flight, goes_up=goes_up)
    way_on = first_ahead(ground, step.robot, memory.way_on(ground, level_z, _OFF_STAIRS_M))
    to = stairs_ahead(ground, *here, flight, goes_up=goes_up, on_slope=on_slope)
    if memory.is_storey_away and not on_slope and way_on.any():
        to = way_on
    words = f"on the stairs {_where_to(memory, climbing, goes_up=goes_up)}"
    if not to.any() and memory.is_off_floor and not climbing.turned:
        to = way_on
    turn = Action.TURN_LEFT
    if not memory.is_off_floor and not to.any():
        turn = turn_towards(step.robot, connector.beyond, step.motion)
    if turn is None or climbing.turned >= step.motion.turns_of_a_circle:
        return _given_up(step, memory, plan, climbing)
    action = None
    if to.any():
        with step.clock("plan"):
            action = step_over_ground(
                ground, step.robot, to, step.motion, touching=climbing.touching
            )
    climbing = replace(climbing, turned=0 if action is not None else climbing.turned + 1)
    if action is None:
        words += ", looking where they lead on"
    decision = Decision(action or turn, Mode.CLIMB, words)
    return decision, replace(plan, climbing=climbing)


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
    moved_m = plan.ordered[0].distance_to(*step.robot.xy)
    return moved_m < _MOVED_SHARE * step.motion.forward_m


def _given_up(
    step: Step, memory: Memory, plan: Plan, climbing: Climbing
) -> tuple[Decision | Phase, Plan]:
    """Turn back; end the attempt on level ground, or where the robot has turned back already."""
    if memory.is_off_floor and not (memory.on_stairs or climbing.is_back):
        memory.reached_level(climbing.connector)
        step.events.append("another level reached")
        return Phase.LOOK_AROUND, replace(plan, climbing=None)
    memory.give_up(climbing.connector)
    if climbing.is_back or not memory.on_stairs:
        step.events.append("stairs given up")
        return Phase.LOOK_AROUND, replace(plan, climbing=None)
    step.events.append("turning back on the stairs")
    connector = memory.connectors[climbing.connector]
    flight = flight_from(connector, goes_up=not connector.goes_up)
    back = Climbing(climbing.connector, is_back=True, flight=flight)
    decision = Decision(Action.TURN_LEFT, Mode.CLIMB, "the stairs lead nowhere, turning back")
    return decision, replace(plan, climbing=back)
