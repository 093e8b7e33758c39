"""Published results of other methods, and a run beside the rows of the HyPerNav paper.

They are for orientation only: data sets, success distances, stop rules and step sizes differ, so
two rows can be compared only after reading all columns, and none is a target. Rows quoted from
another publication's table say so, and so do rows whose publication leaves something unstated.

A row of the paper is set beside the run's episodes of the same scene or goal. What else differs
between the two is said in sentences, since no run is the paper's own.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import yaml

from hypernav.core.episode import MAX_STEPS
from hypernav.core.goal import Goal
from hypernav.lab.datasets import paper_results
from hypernav.lab.datasets.benchmark_files import scene_number
from hypernav.lab.datasets.paper_results import PaperRuns, RobotRow, Score
from hypernav.lab.evaluation.record import EpisodeRecord
from hypernav.lab.evaluation.report.run_data import RunData
from hypernav.lab.evaluation.report.tables import own_protocol
from hypernav.lab.evaluation.statistics import Estimate, mean_with_interval
from hypernav.simulator.worlds.config import NoiseConfig

_UNSTATED = "unstated"


@dataclass(frozen=True)
class Published:
    """One result of a publication.

    Attributes:
        method: Name of the method in the publication.
        dataset: Data set, its version and split.
        success_percent: Success rate, percent.
        spl_percent: SPL, percent.
        protocol: Protocol of the publication, and its differences from ours.
        source: Citation of the publication that holds the numbers.
        url: Address of that publication or of the method's code; empty if there is none to give.
        reached: What counts as reached, and the stop rule.
        step: Length of a step.
        step_seconds: Time of a step as the HyPerNav paper gives it, seconds; None where it
            doesn't.
    """

    method: str
    dataset: str
    success_percent: float
    spl_percent: float
    protocol: str
    source: str
    url: str = ""
    reached: str = _UNSTATED
    step: str = _UNSTATED
    step_seconds: float | None = None


_QUOTED = "as quoted by the HyPerNav paper, which did not run it again"


def _in_simulation(runs: PaperRuns, version: str, step_seconds: float | None = None) -> Published:
    mean = runs.plain_mean
    return Published(
        "HyPerNav",
        f"{runs.title} {runs.split}{version}; {len(runs.scenes)} scenes are listed, with "
        f"{runs.episodes:,} episodes",
        runs.total.success_percent,
        runs.total.spl_percent,
        f"real scans; {paper_results.MODEL} is the main model, {paper_results.DETECTOR} gives the "
        f"boxes, {paper_results.SEGMENTER} the masks; run on "
        f"{paper_results.MACHINE}; camera and success distance are unstated. Plain means of the "
        f"scenes that it lists ({', '.join(runs.scenes)}) are {mean.success_percent:.1f} and "
        f"{mean.spl_percent:.1f}; the table is a clip, so its average is probably of more scenes",
        f"HyPerNav, tables “Average Performance in HM3D, OVON” and “{runs.table}”",
        step="0.5 m",
        step_seconds=step_seconds,
    )


def _with_robot(row: RobotRow) -> Published:
    return Published(
        "HyPerNav" if row.method == "HyPerNav" else "Nearest frontier",
        f"a real robot, {row.goal}, {row.found} of {row.searches} found",
        row.score.success_percent,
        row.score.spl_percent,
        paper_results.ROBOT_SETTING,
        f"HyPerNav, table “{paper_results.ROBOT_TABLE}”",
    )


def _of_others() -> Iterator[Published]:
    """The rows of the file; SR and SPL of some are those that the paper quotes."""
    text = Path(__file__).with_name("published.yaml").read_text(encoding="utf-8")
    for row in yaml.safe_load(text):
        if quoted := row.pop("quoted", None):
            score = paper_results.OTHERS_ON_HM3D[quoted]
            row |= {"success_percent": score.success_percent, "spl_percent": score.spl_percent}
            row["step_seconds"] = paper_results.STEP_SECONDS.get(quoted)
        yield Published(**{"source": _QUOTED} | row)


PUBLISHED: tuple[Published, ...] = (
    _in_simulation(
        paper_results.HM3D,
        ", v1 to judge by its “around 100 episodes” a scene",
        paper_results.STEP_SECONDS["HyPerNav"],
    ),
    _in_simulation(paper_results.OVON, ""),
    *map(_with_robot, paper_results.ROBOT),
    *_of_others(),
)
"""In the order in which they are shown; it is not a ranking."""


_METHODS = {"hypernav": "HyPerNav", "frontier": "frontier"}
"""The paper's names of the agents that it ran itself."""
_FORWARD_M = 0.5
_TURN_DEG = 30.0


@dataclass(frozen=True)
class BesideRow:
    """A row of the paper, and the run's episodes that it can be set beside.

    Attributes:
        table: Title of the paper's table.
        name: What the row is about: a scene's number, a goal, or the average.
        paper: The paper's numbers.
        success: Success rate of the run; None where it has no such episode.
        spl: Mean SPL of the run; None where it has no such episode.
    """

    table: str
    name: str
    paper: Score
    success: Estimate | None
    spl: Estimate | None

    @property
    def episodes(self) -> int:
        """Number of the run's episodes."""
        return 0 if self.success is None else self.success.count


@dataclass(frozen=True)
class BesidePaper:
    """A run beside the paper.

    Attributes:
        rows: The rows of the paper about the run's data set and method; empty if there are none.
        differences: What differs, in sentences; never empty.
    """

    rows: list[BesideRow]
    differences: list[str]


def beside_paper(run: RunData) -> BesidePaper:
    """Set a run beside the paper's rows."""
    printed = None if run.benchmark is None else run.benchmark.printed
    method = _METHODS.get(str(run.who["agent"]), "")
    robot = [row for row in paper_results.ROBOT if row.method == method and _of_goal(run, row)]
    rows = [*(_scene_rows(run, printed) if printed else ()), *(_robot_row(run, r) for r in robot)]
    differences = [
        *(_of_scenes(run, printed) if printed else _of_other_buildings(run)),
        *_of_method(run, printed),
        *(_of_robot(run) if robot else ()),
    ]
    return BesidePaper(rows, differences)


def _scene_rows(run: RunData, printed: PaperRuns) -> Iterator[BesideRow]:
    """The average, over all episodes of the run; that of the listed scenes; and each of these."""
    listed = [r for r in run.counted if scene_number(r.scene_id) in printed.scenes]
    average = "Average Performance in HM3D, OVON"
    yield _row(run, average, f"{printed.title}, average", printed.total, run.counted)
    mean = f"{printed.title}, mean of its scenes"
    yield _row(run, printed.table, mean, printed.plain_mean, listed)
    for scene, score in printed.scenes.items():
        own = [record for record in listed if scene_number(record.scene_id) == scene]
        yield _row(run, printed.table, f"{printed.title}, scene {scene}", score, own)


def _robot_row(run: RunData, row: RobotRow) -> BesideRow:
    name = f"robot, {row.goal}, {row.found} of {row.searches}"
    return _row(run, paper_results.ROBOT_TABLE, name, row.score, _of_goal(run, row))


def _of_goal(run: RunData, row: RobotRow) -> list[EpisodeRecord]:
    return [one for one in run.counted if Goal(one.goal).thing.lower() == row.goal]


def _row(
    run: RunData, table: str, name: str, paper: Score, records: Sequence[EpisodeRecord]
) -> BesideRow:
    if not records:
        return BesideRow(table, name, paper, None, None)
    scores = [own_protocol(run).score(record) for record in records]
    scenes = [record.scene_id for record in records]
    return BesideRow(
        table,
        name,
        paper,
        mean_with_interval([float(score.success) for score in scores], scenes),
        mean_with_interval([score.spl for score in scores], scenes),
    )


def _of_other_buildings(run: RunData) -> Iterator[str]:
    titles = f"{paper_results.HM3D.title} and {paper_results.OVON.title}"
    yield f"Other scenes: the paper's tables by scene are of {titles}, the run is of {run.dataset}."


def _of_scenes(run: RunData, printed: PaperRuns) -> Iterator[str]:
    """What differs in scenes and episodes."""
    split = run.dataset.partition("#")[2]
    version, _, name = split.rpartition("/")
    if printed is paper_results.HM3D and version != "v1":
        own = f"are of {version}" if version else "may be of any version"
        yield f"Other episodes: the run's {own}, the paper's seem to be of v1, by its 100 a scene."
    if printed is paper_results.OVON and name and name != "val_unseen":
        yield f"Other episodes: the run's are of {name}, the paper's of {printed.split}."
    found = dict.fromkeys(scene_number(record.scene_id) for record in run.counted)
    if set(printed.scenes).isdisjoint(found):
        yield from _of_other_buildings(run)
    if missing := [scene for scene in printed.scenes if scene not in found]:
        yield f"Scenes of the paper that the run lacks: {', '.join(missing)}."
    if others := [
        scene or "one without a number" for scene in found if scene not in printed.scenes
    ]:
        yield f"Scenes of the run that the paper doesn't list: {', '.join(others)}."
    count = sum(scene_number(record.scene_id) in printed.scenes for record in run.counted)
    if count != printed.episodes:
        yield f"The run has {count:,} episodes in them, the paper's table {printed.episodes:,}."
    yield (
        "The paper's tables by scene are clips, “due to length”, so its average is probably of "
        "more scenes; the run's is of all its episodes."
    )


def _of_method(run: RunData, printed: PaperRuns | None) -> Iterator[str]:
    """What differs in method, networks, robot and protocol."""
    who, config, protocol = run.who, run.configuration["config"], run.configuration["protocol"]
    if len(run.records) < run.wanted:
        yield f"The run is not finished: {len(run.records):,} of {run.wanted:,} episodes."
    if printed is not None and who["agent"] != "hypernav":
        yield f"Another method: the paper's scenes are HyPerNav's, the run is {who['agent']}'s."
    elif who["agent"] not in _METHODS:
        yield f"Another method: the paper ran HyPerNav and frontier, the run is {who['agent']}'s."
    elif who["agent"] == "hypernav" and who["preset"] != "paper":
        yield f"Another method: the run has the preset {who['preset']}, not paper."
    yield from _of_networks(run)
    motion, camera = config["embodiment"]["motion"], config["embodiment"]["camera"]
    own = motion["forward_m"], motion["turn_angle_deg"], protocol["max_steps"]
    if own != (_FORWARD_M, _TURN_DEG, MAX_STEPS):
        yield (
            f"Other actions: steps of {own[0]:g} m, turns of {own[1]:g}° and {own[2]} steps; the "
            f"paper's are {_FORWARD_M:g} m, {_TURN_DEG:g}° and {MAX_STEPS}."
        )
    if not NoiseConfig.model_validate(config["world"]["noise"]).is_off:
        yield "The run's odometry or camera is noisy; the paper names no noise in simulation."
    yield (
        "The paper states neither success distance nor camera of its simulations; the run's are "
        f"{protocol['success_distance_m']:g} m from a view point, and "
        f"{camera['width']}×{camera['height']}, {camera['hfov_deg']:g}° wide."
    )


def _of_networks(run: RunData) -> Iterator[str]:
    who, published = run.who, f"the paper's boxes are {paper_results.DETECTOR}'s"
    model = str(who.get("model", "none"))
    if run.is_told_truth:
        yield f"The simulator told the run what it sees; {published}."
    elif "vlm" not in str(who.get("parts", {}).get("detector", "")):
        yield f"The run's boxes are of {who['detector']}; {published}."
    if model == "none" or "the published one is" in model:
        asked = model.partition(";")[0]
        yield f"The run's model: {asked}; the paper's main one is {paper_results.MODEL}."
    if "in place of" in (words := str(who.get("segmenter", ""))):
        yield f"The run's segmenter: {words}."


def _of_robot(run: RunData) -> Iterator[str]:
    yield (
        f"The robot's rows are of another building: {paper_results.ROBOT_SETTING}. The run is of "
        f"{run.dataset}; five searches a row tell little in any case."
    )
