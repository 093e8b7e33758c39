"""Global perception: draw the map and ask which unvisited block to go to.

Other floors that the robot knows a path to are parts of the question.
"""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64, UInt8

from hypernav.core.components.abilities import answers_at_once
from hypernav.core.components.protocols import BlockReasoner
from hypernav.core.embodiment import Embodiment
from hypernav.core.exploring.exploration import (
    Chosen,
    Destination,
    ExplorationView,
    StairsDestination,
)
from hypernav.core.exploring.floors import KnownFloor, WayOut
from hypernav.core.exploring.overview import Block, FloorBlocks, Overview, Prospects
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.drawing.question_map import QuestionStyle, draw_question_map
from hypernav.search.mapping.blocks import CLIMB_M, blocks_of, drop_blocks, stairs_blocks
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.reachable_area import ReachableArea, fresh_frontiers, frontiers_of
from hypernav.search.mapping.sight_lines import block_prospects, find_legs_m
from hypernav.search.perception.config import OverviewConfig
from hypernav.search.perception.explorers.floor_panels import LEGEND, FloorPanel, draw_floors

_KEY = "blocks"
"""Key of this explorer's notes."""


@dataclass(frozen=True, eq=False)
class OtherFloor(FloorBlocks):
    """The blocks of another floor, and what the robot could reach on it.

    Attributes:
        reach: The map and what of it the robot could reach from where it would arrive.
        range_m: Range of the camera, metres.
    """

    reach: ReachableArea
    range_m: float

    def prospects(self, blocks: Sequence[Block]) -> Prospects:
        """What visits to some of its blocks would show."""
        return block_prospects(self.reach, self.range_m, blocks)


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
        path_m = begins[0].travel_m + CLIMB_M * len(floor.way)
        farther = tuple(replace(one, travel_m=path_m + one.travel_m) for one in blocks)
        found.append(OtherFloor(floor, farther, reach, range_m))
    return found


def by_way_of(way: Sequence[WayOut], there: Chosen, blocks: tuple[Block, ...]) -> Chosen:
    """The destination on the robot's floor from which stairs lead to one on another floor.

    Args:
        way: The stairs, in the order in which they are taken; none on the robot's floor.
        there: The destination.
        blocks: Blocks of the robot's floor that were offered, for the trace.
    """
    for stairs in reversed(way):
        there = StairsDestination(*stairs.xy, there.reason, stairs.connector, then=there)
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


@dataclass(frozen=True, eq=False, kw_only=True)
class MapOverview(Overview):
    """The blocks of a map, whose image, prospects and paths are computed when they are asked for.

    Attributes:
        view: What the robot knows.
        config: Size and style of the image.
        reach: The map and what of it the robot can reach.
        range_m: Range of its camera, metres.
        elsewhere: The other floors.
    """

    view: ExplorationView
    config: OverviewConfig
    reach: ReachableArea
    range_m: float
    elsewhere: Sequence[OtherFloor] = ()

    def draw(
        self, shown: Collection[int], hatched: Collection[int]
    ) -> UInt8[np.ndarray, "height width 3"]:
        """The image of the map with some of the blocks, RGB."""
        view, style, size = self.view, question_style(self.config), self.config.image_px
        drawn = {*shown, *hatched}
        here = [one for one in self.blocks if one.number in drawn]
        if view.ways_out or view.elsewhere:
            panels = floor_panels(view, here, self.reach, self.elsewhere, drawn)
            return draw_floors(panels, style, size=size, excluded=hatched)
        return draw_question_map(
            view.grid,
            here,
            view.robot,
            view.trajectory,
            style,
            size=size,
            excluded=hatched,
            frontier=boundary_of(self.reach),
            things=view.things,
        )

    def prospects(self, blocks: Sequence[Block]) -> Prospects:
        """What visits to some blocks would show."""
        return block_prospects(self.reach, self.range_m, blocks)

    def legs_m(self, blocks: Sequence[Block]) -> Float64[np.ndarray, "blocks blocks"]:
        """Lengths of the paths between some blocks, stairs that begin there included, metres."""
        legs_m = find_legs_m(self.reach, [one.destination for one in blocks])
        extra_m = np.array([0.0 if one.connector is None else CLIMB_M for one in blocks])
        return legs_m + extra_m[:, None] + extra_m


@dataclass
class _Forgotten:
    """What no longer counts as visited (`OverviewConfig.forget_visits`).

    Attributes:
        positions: Number of positions of the trajectory, from its beginning.
        visits: Number of visits, from the first.
    """

    positions: int = 0
    visits: int = 0


def question_style(config: OverviewConfig) -> QuestionStyle:
    """The style of the image that the configuration asks for."""
    return QuestionStyle(
        strong_colors=config.strong_colors,
        frontier=config.draw_frontier,
        fill_obstacles=config.fill_obstacles,
        clear_numbers=config.clear_numbers,
        labels=config.label_things,
    )


@dataclass(frozen=True, eq=False)
class BlockExplorer:
    """Asks a reasoner which block of the map to visit (paper: global perception).

    If the answer lies near a position already visited, the question is asked again with that block
    excluded (paper: "don't answer number [x, …]").

    Attributes:
        reasoner: Reasoner that chooses a block.
        config: Configuration of the question.
        mapping: Size of the blocks.
        clearances_m: Distances of destinations from obstacles, in the order to try, metres.
        embodiment: Range of the camera.
    """

    reasoner: BlockReasoner
    config: OverviewConfig
    mapping: MappingConfig
    clearances_m: tuple[float, ...]
    embodiment: Embodiment

    @property
    def answers_at_once(self) -> bool:
        """See `hypernav.core.components.abilities.answers_at_once`."""
        return answers_at_once(self.reasoner)

    def next_destination(self, view: ExplorationView) -> Chosen | None:
        """A block not visited yet; if none is left, a frontier; None if there is none."""
        destination = self._unvisited(view)
        if destination is None and self.config.forget_visits:
            # The robot is still at the last position.
            view.notes[_KEY] = _Forgotten(len(view.trajectory) - 1, len(view.visits))
            destination = self._unvisited(view)
        return self._last_frontier(view) if destination is None else destination

    def _unvisited(self, view: ExplorationView) -> Chosen | None:
        """Ask about the blocks that can be entered at each clearance, the largest first."""
        offered: tuple[Block, ...] = ()
        for clearance_m in self.clearances_m:
            reach = ReachableArea.of(view.grid, view.robot, self.mapping, clearance_m)
            blocks = blocks_of(reach, self.mapping)
            blocks += stairs_blocks(reach, view.ways_out, len(blocks) + 1)
            blocks += self._unvisited_edges(reach, view, len(blocks) + 1)
            if _squares(blocks) == _squares(offered):
                break
            offered = blocks
            elsewhere = self._other_floors(view, reach, clearance_m, len(blocks) + 1)
            legend = question_style(self.config).legend
            overview = MapOverview(
                blocks,
                view.robot,
                elsewhere=elsewhere,
                seen_m2=view.grid.free_m2,
                legend=legend + LEGEND if view.ways_out or view.elsewhere else legend,
                trajectory=view.trajectory,
                things=view.things,
                camera_image=view.observation.rgb,
                view=view,
                config=self.config,
                reach=reach,
                range_m=self.embodiment.camera.max_depth_m,
            )
            destination = self._ask(overview, view)
            if destination is not None:
                return destination
        return None

    def _other_floors(
        self, view: ExplorationView, here: ReachableArea, clearance_m: float, first: int
    ) -> list[OtherFloor]:
        """The other floors, each with what counts as visited on it."""
        found, range_m = list[OtherFloor](), self.embodiment.camera.max_depth_m
        for floor in other_floors(view, here, self.mapping, clearance_m, range_m, first):
            visited = (one.number for one in floor.blocks if self._was_visited(one, floor.known))
            found.append(replace(floor, visited=frozenset(visited)))
        return found

    def _last_frontier(self, view: ExplorationView) -> Destination | None:
        """The unvisited frontier that is longest for the path there, whatever blocks it lies in."""
        least_m = self.config.last_frontier_m
        if least_m is None:
            return None
        fresh = fresh_frontiers(
            view.grid,
            view.robot,
            self.mapping.model_copy(update={"frontier_min_size_m": least_m}),
            self.clearances_m,
            visits=self._visits(view),
            visited_radius_m=self.config.visited_radius_m,
        )
        if not fresh:
            return None
        best = min(fresh, key=lambda one: one.travel_m / one.size_m)
        size = f"{best.size_m:.1f} m long, {best.travel_m:.1f} m away"
        return Destination(*best.destination, reason=f"no block is left; frontier: {size}")

    def _ask(self, overview: Overview, view: ExplorationView) -> Chosen | None:
        blocks = overview.blocks
        excluded: frozenset[int] = frozenset()
        for _ in range(self.config.max_questions or len(blocks)):
            choice = self.reasoner.choose(overview, view.goal, excluded)
            if choice.number is None:
                return None
            block = overview.block(choice.number)
            floor = overview.floor_of(block.number)
            if not self._was_visited(block, view if floor is None else floor.known):
                there = _there(block, choice.reason)
                return by_way_of(() if floor is None else floor.known.way, there, blocks)
            excluded |= {choice.number}
        return None

    def _unvisited_edges(
        self, reach: ReachableArea, view: ExplorationView, first: int
    ) -> tuple[Block, ...]:
        """Edges of the floor as blocks: visited ones would only use up questions."""
        edges = drop_blocks(reach, view.drops, first)
        new = [one for one in edges if not self._was_visited(one, view)]
        return tuple(replace(one, number=first + k) for k, one in enumerate(new))

    def _was_visited(self, block: Block, floor: ExplorationView | KnownFloor) -> bool:
        """Whether a block of a floor counts as visited; stairs never do."""
        radius_m = self.config.visited_radius_m
        return block.connector is None and any(
            math.dist(block.destination, visit) < radius_m for visit in self._visits(floor)
        )

    def _visits(self, floor: ExplorationView | KnownFloor) -> Sequence[tuple[float, float]]:
        """Positions ``(x, y)`` that count as visited on a floor, ``map`` frame, metres."""
        forgotten: _Forgotten = floor.notes.get(_KEY, _Forgotten())
        ended = floor.visits[forgotten.visits :]
        match self.config.visited:
            case "positions":
                return [*floor.trajectory[forgotten.positions :], *ended[-1:]]
            case "destinations":
                return ended
            case "none":
                return []


def _there(block: Block, reason: str) -> Chosen:
    if block.connector is None:
        return Destination(*block.destination, reason, face=block.face)
    return StairsDestination(*block.destination, reason, block.connector)


def _squares(blocks: tuple[Block, ...]) -> set[tuple[float, float, int]]:
    """Lower left corners of the blocks, metres, and lengths of their frontiers, cells."""
    return {(block.x_min, block.y_min, block.frontier_cells) for block in blocks}
