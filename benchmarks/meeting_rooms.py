"""Search twelve meeting rooms of boxes, whose screen is seen long before it is reached.

Run: python benchmarks/meeting_rooms.py

The rooms differ in the depth of the sideboard under the screen and in the width of the aisle before
it; the search begins in the corridor and has 300 steps.
"""

import math
import sys
from pathlib import Path

from rich.console import Console
from rich.table import Table

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from hypernav.app.build.agents import build_search
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.trace import ExchangeLog
from hypernav.lab.episodes.episode_run import EpisodeResult, EpisodeRun
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from meeting_room import meeting_room
from small_episodes import episode_from
from small_worlds import small_config

START = Pose2(10.5, 1.0, math.pi)
SIZES_M = (
    *((0.60, 0.40), (0.60, 0.50), (0.66, 0.46), (0.70, 0.50), (0.70, 0.60), (0.74, 0.50)),
    *((0.76, 0.46), (0.76, 0.50), (0.78, 0.50), (0.78, 0.60), (0.80, 0.50), (0.82, 0.46)),
)
"""Depth of the sideboard and width of the aisle."""
STEPS = 300


def search(board_m: float, aisle_m: float, *, open_the_way: bool) -> EpisodeResult:
    config = small_config(search={"max_steps": STEPS, "open_the_way": open_the_way})
    agent = build_search(config, GroundTruthDetector(), ExchangeLog(), agent="hypernav")
    world = meeting_room(board_m=board_m, aisle_m=aisle_m)
    run = EpisodeRun(agent, world, episode_from(START, "tv", max_steps=STEPS))
    for _ in run:
        pass
    return run.result()


def main() -> None:
    """Print every search, without and with `search.open_the_way`."""
    table = Table("sideboard, m", "aisle, m", "without", "SPL", "with", "SPL")
    sums, found = [0.0, 0.0], [0, 0]
    for board_m, aisle_m in SIZES_M:
        cells = list[str]()
        for which, open_the_way in enumerate((False, True)):
            result = search(board_m, aisle_m, open_the_way=open_the_way)
            sums[which] += result.metrics.spl
            found[which] += result.metrics.success
            cells += [f"{result.outcome.value}, {result.steps} steps", f"{result.metrics.spl:.3f}"]
        table.add_row(f"{board_m:.2f}", f"{aisle_m:.2f}", *cells)
    means = [f"{spl / len(SIZES_M):.3f}" for spl in sums]
    table.add_row("found", "", str(found[0]), means[0], str(found[1]), means[1])
    Console().print(table)


if __name__ == "__main__":
    main()
