"""All that the HyPerNav paper prints of its results, each number with the table that holds it.

The numbers of this package about the paper are read from here: those of reports, of the paper's
benchmarks, and of ``hypernav report --published``.
"""

from collections.abc import Mapping
from dataclasses import dataclass

MODEL = "QwenVL-7B"
"""The paper's "main VLM"."""
DETECTOR = "Qwen-VL"
"""Model that gives the boxes; it doesn't say of which size."""
SEGMENTER = "MobileSAM"
STEP_SECONDS = {"HyPerNav": 1.2, "NavVLM": 3.3}
"""Time of a step in "What is the HyPerNav navigation time consumption?", seconds."""
MACHINE = "a server with a GTX4080"
"""Machine of the simulations."""
REFINEMENT_DROPS_PERCENT = {"vision occlusion": 70, "goal in obstacle": 67}
"""Drops in "How much does goal refinement helps the navigation?", in a single scene."""


@dataclass(frozen=True)
class Score:
    """A pair of numbers, as all tables have them.

    Attributes:
        success_percent: Success rate, percent.
        spl_percent: SPL, percent.
    """

    success_percent: float
    spl_percent: float


@dataclass(frozen=True)
class PaperRuns:
    """The paper's runs on one data set.

    Attributes:
        title: Data set, for people.
        split: Split that the scenes belong to.
        total: Row "Ours" of the table "Average Performance in HM3D, OVON".
        table: Title of the table by scene, which the paper calls a clip.
        episodes: Number of episodes that this table includes.
        scenes: Rows of this table, by the number of the scene.
    """

    title: str
    split: str
    total: Score
    table: str
    episodes: int
    scenes: Mapping[str, Score]

    @property
    def plain_mean(self) -> Score:
        """Mean of the scenes' rows, each with the same weight."""
        rows = self.scenes.values()
        return Score(
            sum(row.success_percent for row in rows) / len(rows),
            sum(row.spl_percent for row in rows) / len(rows),
        )

    @property
    def selection(self) -> str:
        """The scenes as ``--scenes`` takes them."""
        return ",".join(self.scenes)


HM3D = PaperRuns(
    title="HM3D",
    split="val",
    total=Score(53.4, 35.8),
    table="clip of HyPerNav detailed performance in HM3D",
    episodes=1000,
    scenes={
        "802": Score(47.5, 33.1),
        "813": Score(61.5, 40.3),
        "814": Score(37.5, 22.6),
        "824": Score(55.6, 39.5),
        "829": Score(51.9, 36.9),
        "835": Score(47.5, 40.8),
        "853": Score(62.6, 42.4),
        "876": Score(41.4, 27.7),
        "877": Score(59.3, 33.0),
        "880": Score(59.6, 31.8),
    },
)

OVON = PaperRuns(
    title="HM3D-OVON",
    split="val unseen",
    total=Score(65.4, 43.7),
    table="clip of HyPerNav detailed performance in OVON",
    episodes=961,
    scenes={
        "820": Score(75.0, 50.7),
        "835": Score(68.7, 46.4),
        "810": Score(50.0, 38.2),
        "847": Score(76.9, 52.2),
        "821": Score(38.9, 29.8),
        "831": Score(42.9, 22.8),
        "853": Score(70.2, 42.6),
        "873": Score(75.9, 59.2),
        "877": Score(67.3, 45.9),
        "878": Score(80.3, 55.2),
        "880": Score(86.7, 45.7),
        "890": Score(63.6, 44.2),
    },
)

OTHERS_ON_HM3D: Mapping[str, Score] = {
    "PIRLNav": Score(64.1, 27.1),
    "ZSON": Score(25.5, 12.6),
    "VLFM": Score(52.5, 30.4),
    "NavVLM": Score(48.0, 33.5),
    "PIVOT": Score(24.6, 10.6),
    "VLMNav": Score(50.4, 21.0),
    "DyNaVLM": Score(45.0, 23.2),
}
"""Rows of other methods in "Average Performance in HM3D, OVON", which the paper quotes."""


@dataclass(frozen=True)
class RobotRow:
    """Searches for one kind of thing with the paper's robot, in an office.

    Attributes:
        goal: What was searched for.
        method: "frontier" or "HyPerNav".
        found: Number of searches that found it.
        searches: Number of searches.
        spl_percent: SPL, percent.
    """

    goal: str
    method: str
    found: int
    searches: int
    spl_percent: float

    @property
    def score(self) -> Score:
        """Success rate and SPL."""
        return Score(100.0 * self.found / self.searches, self.spl_percent)


ROBOT_TABLE = "Real-world ablation on goal “bed” and “umbrella”"
ROBOT = (
    RobotRow("bed", "frontier", 3, 5, 24.0),
    RobotRow("bed", "HyPerNav", 4, 5, 50.0),
    RobotRow("umbrella", "frontier", 4, 5, 35.0),
    RobotRow("umbrella", "HyPerNav", 3, 5, 42.0),
)
ROBOT_SETTING = (
    "the authors' lab office; a wheeled half-humanoid with an Azure DK camera and odometry by IMU, "
    "a vision-language model on a server with an RTX 4090 behind Flask; the same detector and "
    "segmenter for both methods; steps differ slightly from the simulation's; shortest paths "
    "measured by hand"
)
