"""Exploration of the frontier around which the views fit the goal best (VLFM).

Source: Yokoyama et al., "VLFM: Vision-Language Frontier Maps for Zero-Shot Semantic Navigation",
2024, and its released code.
"""

from dataclasses import dataclass, field

import cv2
import numpy as np

from hypernav.core.components.protocols import SceneScorer
from hypernav.core.embodiment import Embodiment
from hypernav.core.exploring.exploration import Destination, ExplorationView
from hypernav.core.exploring.insight import Insight, ValueImage
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.trace import ExchangeLog
from hypernav.search.mapping.config import MappingConfig
from hypernav.search.mapping.reachable_area import fresh_frontiers
from hypernav.search.rivals.config import ValueFrontierConfig
from hypernav.search.rivals.vlfm.value_map import ValueMap

_KEY = "vlfm"
"""Key of this explorer's notes."""
_SHOWN_EVERY = 4
"""Every fourth cell of the value map, in both directions, is shown."""
_NEAR_M = 0.5
"""Distance from a frontier's destination within which values count, and within which a frontier is
the one of the step before (VLFM's code)."""
_STAY_MARGIN = 0.01
"""Amount by which the value of the present frontier may fall from one step to the next before the
best is gone to (VLFM's code)."""
_LEAST_POCKET_M2 = 1.5
"""Area below which unknown floor in the middle of known floor counts as explored (VLFM's code)."""


@dataclass(frozen=True, eq=False)
class ValueFrontierExplorer:
    """Scores every view, and at every step goes to the frontier with the best values around it.

    Map, frontiers' reach, planner and arrival are those of all agents of this package (ours: the
    original drives by a learned policy).

    Attributes:
        scorer: Scorer of the views.
        log: Log of all choices, for the trace.
        embodiment: Range of the camera.
        mapping: Cells of the map, length of the shortest frontier.
        clearances_m: Distances of destinations from obstacles, in the order to try, metres.
        config: Choice of a frontier.
    """

    scorer: SceneScorer
    log: ExchangeLog
    embodiment: Embodiment
    mapping: MappingConfig
    clearances_m: tuple[float, ...]
    config: ValueFrontierConfig = field(default_factory=ValueFrontierConfig)

    def learn(self, view: ExplorationView) -> None:
        """Score the view and fuse the score into the value map, which lasts for one goal.

        Raises:
            ModelUnavailableError: The scorer's model did not answer.
        """
        score = self.scorer.score(view.observation, view.goal)
        self._notes(view).values.integrate(view.observation, score)

    def next_destination(self, view: ExplorationView) -> Destination | None:
        """The frontier of the step before while its value holds, else the best; None if none."""
        notes = self._notes(view)
        fresh = fresh_frontiers(
            without_pockets(view.grid, _LEAST_POCKET_M2),
            view.robot,
            self.mapping,
            self.clearances_m,
            visits=view.visits,
            visited_radius_m=self.config.visited_radius_m,
        )
        if fresh:
            return self._best([one.destination for one in fresh], notes)
        notes.latest = None
        self._record("no frontier is left that can be reached")
        return None

    def _notes(self, view: ExplorationView) -> "_Notes":
        if _KEY not in view.notes:
            values = ValueMap(self.embodiment.camera, cell_size_m=self.mapping.cell_size_m)
            view.notes[_KEY] = _Notes(values)
        return view.notes[_KEY]

    def _best(self, positions: list[tuple[float, float]], notes: "_Notes") -> Destination:
        points = np.array(positions)
        scores = notes.values.median_near(points, _NEAR_M)
        chosen, why = int(scores.argmax()), "the best"
        if notes.latest is not None:
            before, score_before = notes.latest
            away = np.hypot(*(points - before).T)
            nearest = int(away.argmin())
            is_same = away[nearest] <= _NEAR_M
            if is_same and scores[nearest] + _STAY_MARGIN > score_before:
                chosen, why = nearest, "kept"
        x, y = positions[chosen]
        score = float(scores[chosen])
        moved = notes.latest is None or notes.latest[0] != (x, y)
        notes.latest = (x, y), score
        reason = f"frontier with value {score:.2f}, {why} of {len(positions)}"
        insight = None
        if moved:
            self._record(reason)
            insight = self._shown(notes.values)
        return Destination(x, y, reason=reason, insight=insight, most_steps=1)

    def _shown(self, world: ValueMap) -> Insight:
        """The value map, for videos and pages."""
        every = _SHOWN_EVERY
        values = world.values[::every, ::every]
        cell_m = every * self.mapping.cell_size_m
        return Insight(values=ValueImage.of(values, world.origin, cell_m))

    def _record(self, answer: str) -> None:
        question = "Around which frontier did views fit the goal best?"
        self.log.note("choose frontier", "value map", question, answer)


@dataclass
class _Notes:
    """What the explorer notes in the search for one goal.

    Attributes:
        values: The value map.
        latest: Destination ``(x, y)``, ``map`` frame, metres, of the latest choice, and its value.
    """

    values: ValueMap
    latest: tuple[tuple[float, float], float] | None = None


def without_pockets(grid: OccupancyGrid, least_m2: float) -> OccupancyGrid:
    """A cropped copy of the map; connected unknown areas smaller than `least_m2` (m²) are free."""
    grid = grid.cropped()
    unknown = (grid.cells == Cell.UNKNOWN).view(np.uint8)
    _, parts = cv2.connectedComponents(unknown, connectivity=4)
    least_cells = least_m2 / grid.resolution_m**2
    is_pocket = np.bincount(parts.ravel()) < least_cells
    is_pocket[0] = False  # what is known
    cells = np.where(is_pocket[parts], np.uint8(Cell.FREE), grid.cells)
    return OccupancyGrid(cells, grid.resolution_m, grid.origin)
