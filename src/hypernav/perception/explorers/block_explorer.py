"""Global perception: draw the map, ask which block to visit, remember what was visited."""

import math
from collections.abc import Collection, Sequence
from typing import Literal

import numpy as np
from jaxtyping import Float64, UInt8
from pydantic import Field

from hypernav.core.components.abilities import answers_at_once
from hypernav.core.components.protocols import BlockReasoner
from hypernav.core.config import RoomConfig
from hypernav.core.destination import Destination
from hypernav.core.embodiment import Embodiment
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.overview import Block, Overview, Prospects
from hypernav.core.sightings import Sightings
from hypernav.mapping.blocks import blocks_of
from hypernav.mapping.config import MappingConfig
from hypernav.mapping.frontiers import find_frontiers, nearest_frontier
from hypernav.mapping.prospects import find_legs_m, find_prospects
from hypernav.mapping.reachable_area import ReachableArea
from hypernav.show.drawing.question_map import QuestionStyle, draw_question_map

# Named here, since building a type takes 0.1 ms and every question defines functions with these.
_Image = UInt8[np.ndarray, "_ _ 3"]
_Legs = Float64[np.ndarray, "_ _"]


class OverviewConfig(RoomConfig):
    """Configuration of the map question. The paper gives no values for it: these are ours.

    Attributes:
        image_px: Side of the image of the map, pixels; a multiple of 28 fits the patches of most
            models.
        strong_colors: Whether unknown stands out from free floor, at least three to one.
        draw_frontier: Whether the boundary to the unknown is drawn in a colour.
        fill_obstacles: Whether the inside of furniture and walls, which no camera sees, is filled.
        clear_numbers: Whether numbers are larger and keep off furniture.
        label_things: Whether things that a detector has named beside the goal are written into the
            map; not where the next question is prefetched.
        visited: What counts as a visit: "destinations" that were reached or given up, or the
            "positions" that the robot has been at (paper), beside the latest destination, so that
            the next is a new one. "none": nothing is remembered.
        visited_radius_m: Distance from a visit, metres, within which a destination counts as
            visited.
        max_questions: Largest number of questions for one choice, with visited blocks excluded;
            None asks until an unvisited block is named or all are excluded (paper).
        forget_visits: Whether visits are forgotten when all blocks are excluded, so that the search
            goes on; else nothing is left to explore.
        last_frontier_m: Length of the shortest frontier that is visited where no block is left,
            metres: the edges of blocks and thin obstacles cut boundaries into pieces too short to
            count, and a square with little floor is no block. None visits none.
    """

    image_px: int = Field(default=756, ge=64, le=4096)
    strong_colors: bool = True
    draw_frontier: bool = True
    fill_obstacles: bool = True
    clear_numbers: bool = True
    label_things: bool = True
    visited: Literal["destinations", "positions", "none"] = "destinations"
    visited_radius_m: float = Field(default=0.5, ge=0.0, le=100.0)
    max_questions: int | None = Field(default=4, ge=1, le=1000)
    forget_visits: bool = False
    last_frontier_m: float | None = Field(default=0.25, ge=0.0, le=50.0)

    @property
    def style(self) -> QuestionStyle:
        """Style of the image."""
        return QuestionStyle(
            strong_colors=self.strong_colors,
            frontier=self.draw_frontier,
            fill_obstacles=self.fill_obstacles,
            clear_numbers=self.clear_numbers,
            labels=self.label_things,
        )


class BlockExplorer:
    """Asks a reasoner which block of the map to visit (paper: global perception).

    If the answer lies near a position already visited, the question is asked again with that block
    excluded (paper: "don't answer number [x, …]").
    """

    def __init__(
        self,
        reasoner: BlockReasoner,
        config: OverviewConfig,
        mapping: MappingConfig,
        clearances_m: tuple[float, ...],
        embodiment: Embodiment,
        sightings: Sightings | None = None,
    ) -> None:
        """Create it.

        Args:
            reasoner: Reasoner that chooses a block.
            config: Configuration of the question.
            mapping: Size of the blocks.
            clearances_m: Distances of destinations from obstacles, in the order to try, metres.
            embodiment: Range of the camera.
            sightings: Memory of what was seen; None where nobody keeps one.
        """
        self._reasoner = reasoner
        self._config = config
        self._mapping = mapping
        self._clearances_m = clearances_m
        self._range_m = embodiment.camera.max_depth_m
        self._sightings = sightings or Sightings()
        self.reset(Goal("nothing yet"))

    @property
    def answers_at_once(self) -> bool:
        """See `hypernav.core.components.abilities.answers_at_once`."""
        return answers_at_once(self._reasoner)

    def reset(self, goal: Goal) -> None:
        """Forget all visits."""
        self._goal = goal
        self._ended: list[tuple[float, float]] = []
        self._forgotten_positions = 0

    def remember_visit(self, x: float, y: float) -> None:
        """Note a destination that was reached or given up."""
        self._ended.append((x, y))

    def next_destination(
        self, grid: OccupancyGrid, robot: Pose2, trajectory: Sequence[tuple[float, float]]
    ) -> Destination | None:
        """A block that was not visited, or a frontier beside all blocks; None if there is none."""
        destination = self._unvisited(grid, robot, trajectory)
        if destination is None and self._config.forget_visits:
            self._ended.clear()
            self._forgotten_positions = len(trajectory) - 1  # the robot is at the last one still
            destination = self._unvisited(grid, robot, trajectory)
        if destination is None:
            destination = self._last_frontier(grid, robot, trajectory)
        return destination

    def _unvisited(
        self, grid: OccupancyGrid, robot: Pose2, trajectory: Sequence[tuple[float, float]]
    ) -> Destination | None:
        """Ask about all blocks, then about those that a robot closer to obstacles can enter."""
        offered: tuple[Block, ...] = ()
        for clearance_m in self._clearances_m:
            reach = ReachableArea.of(grid, robot, self._mapping, clearance_m)
            blocks = blocks_of(reach, self._mapping)
            if _squares(blocks) == _squares(offered):
                break
            offered = blocks
            overview = self._overview(blocks, reach, grid, robot, trajectory, clearance_m)
            destination = self._ask(overview, trajectory)
            if destination is not None:
                return destination
        return None

    def _last_frontier(
        self, grid: OccupancyGrid, robot: Pose2, trajectory: Sequence[tuple[float, float]]
    ) -> Destination | None:
        """The nearest unvisited frontier, whatever blocks it lies in."""
        least_m = self._config.last_frontier_m
        if least_m is None:
            return None
        nearest = nearest_frontier(
            grid,
            robot,
            self._mapping.model_copy(update={"frontier_min_size_m": least_m}),
            self._clearances_m,
            visits=self._visits(trajectory),
            visited_radius_m=self._config.visited_radius_m,
        )
        if nearest is None:
            return None
        reason = f"no block is left; nearest frontier: {nearest.size_m:.1f} m long"
        return Destination(*nearest.destination, reason=reason)

    def _overview(
        self,
        blocks: tuple[Block, ...],
        reach: ReachableArea,
        grid: OccupancyGrid,
        robot: Pose2,
        trajectory: Sequence[tuple[float, float]],
        clearance_m: float,
    ) -> Overview:
        style, size = self._config.style, self._config.image_px
        things = self._sightings.things

        def draw(shown: Collection[int], excluded: Collection[int]) -> _Image:
            found = find_frontiers(grid, robot, self._mapping, clearance_m)
            frontier = np.concatenate([np.empty((0, 2)), *(one.points for one in found)])
            return draw_question_map(
                grid,
                [one for one in blocks if one.number in shown or one.number in excluded],
                robot,
                trajectory,
                style,
                size=size,
                excluded=excluded,
                frontier=frontier,
                things=things,
            )

        def prospects(of: Sequence[Block]) -> Prospects:
            return find_prospects(reach, [one.destination for one in of], self._range_m)

        def legs_m(between: Sequence[Block]) -> _Legs:
            return find_legs_m(reach, [one.destination for one in between])

        return Overview(
            draw,
            blocks,
            robot,
            prospects=prospects,
            legs_m=legs_m,
            legend=style.legend,
            trajectory=trajectory,
            things=things,
            camera_image=self._sightings.image,
        )

    def _ask(
        self, overview: Overview, trajectory: Sequence[tuple[float, float]]
    ) -> Destination | None:
        blocks, radius_m = overview.blocks, self._config.visited_radius_m
        excluded: frozenset[int] = frozenset()
        visits = self._visits(trajectory)
        for _ in range(self._config.max_questions or len(blocks)):
            choice = self._reasoner.choose(overview, self._goal, excluded)
            if choice.number is None:
                return None
            block = overview.block(choice.number)
            if all(math.dist(block.destination, visit) >= radius_m for visit in visits):
                return Destination(*block.destination, reason=choice.reason, blocks=blocks)
            excluded |= {choice.number}
        return None

    def _visits(self, trajectory: Sequence[tuple[float, float]]) -> Sequence[tuple[float, float]]:
        """All that counts as visited, metres."""
        match self._config.visited:
            case "positions":
                return [*trajectory[self._forgotten_positions :], *self._ended[-1:]]
            case "destinations":
                return self._ended
            case "none":
                return []


def _squares(blocks: tuple[Block, ...]) -> set[tuple[float, float, int]]:
    """Corners of the blocks, and the length of their boundaries to the unknown."""
    return {(block.x_min, block.y_min, block.frontier_cells) for block in blocks}
