"""Pursuit of a goal that was seen too far away to be measured, or on another floor."""

import math
from dataclasses import replace

from hypernav.agents.phases.recall import errand
from hypernav.agents.plan import Plan, patience_of
from hypernav.agents.step import Step
from hypernav.core.exploring.exploration import Destination
from hypernav.mapping.memory.memory import Memory
from hypernav.mapping.memory.ways import (
    forget_seen_from_elsewhere,
    seen_from_elsewhere,
    ways_to_sighting,
)


def pursuing(step: Step, memory: Memory, plan: Plan) -> Plan:
    """The plan that heads for a goal that was seen too far away, or on another floor."""
    if not step.config.pursue_far_sightings or errand(step, memory) is not None:
        return plan
    far, below_or_above = memory.search.evidence.far_position, seen_from_elsewhere(memory)
    if far is not None:
        reason = f"{step.goal.told} is in sight, too far away to be measured"
        return _towards(far, "goal seen far away", reason, step, memory, plan)
    if below_or_above is not None:
        reason = f"{step.goal.told} was seen there from another floor"
        return _towards(below_or_above, "floor of the goal reached", reason, step, memory, plan)
    return _over_stairs(step, memory, plan) if step.config.use_stairs else plan


def _towards(
    position: tuple[float, float], event: str, reason: str, step: Step, memory: Memory, plan: Plan
) -> Plan:
    """The plan that heads for a position of a sighting, unless it was pursued in vain before."""
    config = step.config
    near_m = 2.0 * config.arrival_distance_m
    if any(math.dist(position, other) <= near_m for other in plan.exploring.pursued):
        forget_sighting(memory, position)
        return plan
    if plan.destination is None or not plan.destination.is_sighting:
        step.events.append(event)
        plan = plan.explore(patience=patience_of(config))
    return plan.explore(destination=Destination(*position, reason=reason, is_sighting=True))


def _over_stairs(step: Step, memory: Memory, plan: Plan) -> Plan:
    """The plan that takes the nearest stairs towards a floor on which the goal was seen."""
    ways = ways_to_sighting(memory)
    if not ways:
        return plan
    destination = plan.destination
    if destination is not None and destination.connector in [one.connector for one in ways]:
        return plan
    nearest = min(ways, key=lambda one: step.robot.distance_to(*one.xy))
    step.events.append("goal seen on another floor")
    reason = f"{step.goal.told} was seen on another floor: {nearest.words}"
    there = Destination(*nearest.xy, reason=reason, connector=nearest.connector, holds=True)
    return replace(plan, exploring=plan.exploring.towards(there, step.config))


def forget_sighting(memory: Memory, position: tuple[float, float]) -> None:
    """Pursue no more what was seen at a position, metres, too far away or from another floor."""
    search = memory.search
    if search.evidence.far_position == position:
        search.evidence = replace(search.evidence, far_position=None)
    forget_seen_from_elsewhere(memory, position)
