"""Other floors that the robot knows a way to, as parts of the question where to go."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from jaxtyping import Float64

from hypernav.core.exploring.exploration import Destination, ExplorationView
from hypernav.core.exploring.floors import KnownFloor, WayOut
from hypernav.core.exploring.overview import Block, FloorBlocks
from hypernav.core.geometry.transforms import Pose2
from hypernav.mapping.blocks import CLIMB_M, blocks_of, stairs_blocks
from hypernav.mapping.config import MappingConfig
from hypernav.mapping.reachable_area import ReachableArea, frontiers_of
from hypernav.mapping.sight_lines import block_prospects
from hypernav.perception.explorers.floor_panels import FloorPanel


@dataclass(frozen=True, eq=False)
class OtherFloor(FloorBlocks):
    """The blocks of another floor, and what the robot could reach on it.

    Attributes:
        reach: The map and what of it the robot could reach from where it would arrive.
    """

    reach: ReachableArea


def other_floors(
    view: ExplorationView,
    here: ReachableArea,
    mapping: MappingConfig,
    clearance_m: float,
    range_m: float,
    first: int,
) -> list[OtherFloor]:
    """The floors to which stairs lead that the robot can reach.

    Args:
        view: What the robot knows.
        here: What it can reach on its floor.
        mapping: Size of the blocks.
        clearance_m: Distance from obstacles that its middle keeps, metres.
        range_m: Range of its camera, metres.
        first: Number of the first block.
    """
    found: list[OtherFloor] = []
    for floor in view.elsewhere:
        begins = stairs_blocks(here, floor.way[:1], first)
        if not begins:
            continue
        reach = ReachableArea.of(floor.grid, Pose2(*floor.arrival, 0.0), mapping, clearance_m)
        blocks = blocks_of(reach, mapping, first)
        new = [one for one in floor.stairs if one.to is None]
        blocks += stairs_blocks(reach, new, first + len(blocks))
        first += len(blocks)
        way_m = begins[0].travel_m + CLIMB_M * len(floor.way)
        farther = tuple(replace(one, travel_m=way_m + one.travel_m) for one in blocks)
        prospects = partial(block_prospects, reach, range_m)
        found.append(OtherFloor(floor, farther, prospects, reach))
    return found


def by_way_of(way: Sequence[WayOut], there: Destination, blocks: tuple[Block, ...]) -> Destination:
    """The destination on the robot's floor from which stairs lead to one on another floor.

    Args:
        way: The stairs, in the order in which they are taken.
        there: The destination on the other floor.
        blocks: Blocks of the robot's floor that were offered, for the trace.
    """
    for stairs in reversed(way):
        there = Destination(*stairs.xy, reason=there.reason, connector=stairs.connector, then=there)
    return replace(there, blocks=blocks)


def floor_panels(
    view: ExplorationView,
    blocks: Sequence[Block],
    reach: ReachableArea,
    others: Sequence[OtherFloor],
    drawn: Collection[int],
) -> list[FloorPanel]:
    """What the image shows of the robot's floor and of all others.

    Args:
        view: What the robot knows.
        blocks: Blocks of its floor that are drawn.
        reach: What it can reach there.
        others: The other floors.
        drawn: Numbers of all blocks that are drawn.
    """
    taken = {one.known.way[0].connector: one.known.way[0] for one in others}
    here = KnownFloor(
        view.floor,
        0.0,
        view.grid,
        view.trajectory,
        view.visits,
        view.things,
        stairs=[*view.ways_out, *taken.values()],
        way=(),
        arrival=view.robot.xy,
    )
    panels = [FloorPanel(here, blocks, boundary_of(reach), view.robot)]
    for one in others:
        shown = [block for block in one.blocks if block.number in drawn]
        panels.append(FloorPanel(one.known, shown, boundary_of(one.reach)))
    return panels


def boundary_of(reach: ReachableArea) -> Float64[np.ndarray, "n 2"]:
    """Middles ``(x, y)`` of the cells at the boundary to the unknown, metres."""
    return np.concatenate([np.empty((0, 2)), *(one.points for one in frontiers_of(reach))])
