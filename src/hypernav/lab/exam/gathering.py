"""Makes the questions of one sheet: a search in a generated building, and views around it.

The search of the package runs with true labels and meets what any search meets: incomplete maps,
frames of doors and corridors. The questions to its components are kept with their true answers.
"""

import hashlib
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from hypernav.app.build.agents import build_explorer, build_search
from hypernav.app.build.presets import HyPerNavConfig, preset
from hypernav.app.build.worlds import open_world
from hypernav.core.components.protocols import Explorer
from hypernav.core.episode import Episode, PathLeft
from hypernav.core.exploring.exploration import Chosen, ExplorationView
from hypernav.core.exploring.guidance import (
    TURN_AROUND,
    ArrowChoice,
    ArrowView,
    Direction,
    GuideChoice,
    GuideView,
)
from hypernav.core.exploring.overview import BlockChoice, Overview
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.core.trace import ExchangeLog
from hypernav.core.world import Instance, Simulator
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.lab.episodes.true_paths import true_paths
from hypernav.lab.exam.bank import VIEWS, Sheet
from hypernav.lab.exam.image_questions import close_by, of_frame, of_images, of_stops
from hypernav.lab.exam.questions import ExamQuestion, best_of
from hypernav.search.agents.search import SearchAgent
from hypernav.search.perception.explorers.geometric_reasoner import GeometricReasoner
from hypernav.search.perception.explorers.map_question import offered_blocks
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from hypernav.simulator.houses.episodes.queries import RULES

_SEED = 2
"""The bank's version that made the searches; the third only added questions about images."""
_STEPS = 50  # length of a search
_EVERY = 3
"""Every third frame of a search is asked about."""
_TURN_M = 1.0
"""Cost of turning around or exploring on, as length of path, metres; ours."""
_AHEAD_M = 2.0  # largest distance ahead from which the path of a direction is measured


def questions_of(sheet: Sheet, config: HyPerNavConfig) -> list[ExamQuestion]:
    """All questions of a sheet, in an order by chance, but two about one goal together.

    So an exam that takes some of the questions has images of one thing from two sides, which tell
    how far a model's errors belong to things.

    Args:
        sheet: The search.
        config: What the examined components are built from; only its robot, map and drawing
            matter here.
    """
    base = _base(config)
    world = open_world(sheet.scene, base)
    truth = world.truth
    rng = np.random.default_rng((_SEED, sheet.number, int(sheet.scene.partition(":")[2])))
    goals = _goals(sheet.scene, truth.instances)
    found: list[ExamQuestion] = []
    try:
        for text in rng.permutation(goals).tolist():
            goal = Goal(text)
            if len(truth.goal_truth(goal).view_points):
                start = truth.random_start(rng, goal, nearest_m=5.0)
                found += _of_search(sheet, world, goal, start, goals, config, rng)
                break
        found += of_stops(sheet, world, goals, rng)
        seen = {id(o.subject): o.subject for o in found if isinstance(o.subject, Observation)}
        found += of_images(sheet, world, list(seen.values()), goals, rng)
    finally:
        world.close()
    return _in_pairs(found)


def _in_pairs(questions: Sequence[ExamQuestion]) -> list[ExamQuestion]:
    """First `VIEWS` questions of each kind about each goal, then as many more, and so on."""
    before = Counter[tuple[str, str, str]]()
    placed = []
    for one in sorted(questions, key=lambda one: _hashed(one.id)):
        about = (one.kind, one.stratum, one.goal.text)
        placed.append(((before[about] // VIEWS, _hashed("/".join((one.scene, *about)))), one))
        before[about] += 1
    return [one for _, one in sorted(placed, key=lambda pair: pair[0])]


def _hashed(text: str) -> bytes:
    return hashlib.sha256(text.encode()).digest()


def _base(config: HyPerNavConfig) -> HyPerNavConfig:
    """Configuration of the gathering search: the default preset, with the given robot and map."""
    robot = {"embodiment": config.embodiment, "mapping": config.mapping}
    return preset("default").model_copy(update=robot)


def _goals(scene: str, instances: Sequence[Instance]) -> list[str]:
    """Names of the goals for this kind of building that this one holds."""
    labels = [one.label for one in instances if one.label is not None]
    names = RULES[scene.partition(":")[0]].categories
    return [name for name in names if any(label.satisfies(Goal(name)) for label in labels)]


@dataclass(eq=False)
class _Ears:
    """Reasoner, arrow reasoner and guide in one that keeps what it is asked and chooses nothing."""

    heard: list[Overview | ArrowView | GuideView] = field(default_factory=list)

    def choose(
        self, view: Overview | ArrowView, goal: Goal, *_: object
    ) -> BlockChoice | ArrowChoice:
        self.heard.append(view)
        if isinstance(view, Overview):
            return BlockChoice(None, "only listening")
        return ArrowChoice((), "only listening")

    def direct(self, view: GuideView, goal: Goal) -> GuideChoice:
        self.heard.append(view)
        return GuideChoice(Direction.EXPLORE, "only listening")


@dataclass(frozen=True, eq=False)
class _Listener:
    """The explorer of the search; it also keeps what other explorers would ask of each view."""

    drives: Explorer
    asking: tuple[Explorer, ...]
    ears: _Ears
    views: list[tuple[ExplorationView, list[Overview | ArrowView | GuideView]]]

    def next_destination(self, view: ExplorationView) -> Chosen | None:
        self.ears.heard.clear()
        for explorer in self.asking:
            explorer.next_destination(replace(view, notes={}))
        # An explorer without an answer may ask again; of each type the first question is kept.
        self.views.append((view, list({type(one): one for one in self.ears.heard[::-1]}.values())))
        return self.drives.next_destination(view)


@dataclass(frozen=True, eq=False)
class _Wanderer:
    """Chooses blocks by the geometric rule or at random, so that many kinds of maps arise."""

    rule: GeometricReasoner
    rng: np.random.Generator

    def choose(self, overview: Overview, goal: Goal, excluded: frozenset[int]) -> BlockChoice:
        left = [block.number for block in overview.blocks if block.number not in excluded]
        if not left or self.rng.random() < 0.5:
            return self.rule.choose(overview, goal, excluded)
        return BlockChoice(left[int(self.rng.integers(len(left)))], "by chance")


def _of_search(
    sheet: Sheet,
    world: Simulator,
    goal: Goal,
    start: Pose2,
    goals: Sequence[str],
    config: HyPerNavConfig,
    rng: np.random.Generator,
) -> list[ExamQuestion]:
    log, ears, base = ExchangeLog(), _Ears(), _base(config)
    rule = GeometricReasoner(log, base.geometric)
    drawn = base.model_copy(update={"overview": config.overview, "arrows": config.arrows})
    asking = ("hypernav", "vlmnav", "navvlm")
    agent = build_search(
        base, GroundTruthDetector(), log, reasoner=_Wanderer(rule, rng.spawn(1)[0])
    )
    listener = _Listener(
        agent.components.explorer,
        tuple(build_explorer(drawn, log, name, reasoner=ears) for name in asking),
        ears,
        [],
    )
    agent = SearchAgent(replace(agent.components, explorer=listener))
    episode = Episode(sheet.scene, str(sheet.number), goal, start, max_steps=_STEPS)
    run = EpisodeRun(agent, world, episode, rng=rng)
    left_m = true_paths(run.trial)
    assert left_m is not None
    found: list[ExamQuestion] = []
    for number, step in enumerate(run):
        if listener.views:  # of several in one step the last, on which the robot acts
            view, heard = listener.views[-1]
            listener.views.clear()
            for subject in heard:
                question = _choice(sheet, number, goal, subject, view, left_m, rule, config)
                found += [] if question is None else [question]
        if number % _EVERY == 0:
            found += of_frame(sheet, number, step.observation, goals)
            found += close_by(sheet, number, step.observation, goal, left_m)
    return found


def _choice(
    sheet: Sheet,
    step: int,
    goal: Goal,
    subject: Overview | ArrowView | GuideView,
    view: ExplorationView,
    left_m: PathLeft,
    rule: GeometricReasoner,
    config: HyPerNavConfig,
) -> ExamQuestion | None:
    """A question with the true path lengths of its options; None if all options are right."""
    here, by_rule = view.robot, ""
    match subject:
        case Overview():
            offered = offered_blocks(config.block_choice, subject, frozenset())
            costs = {str(o.number): o.travel_m + left_m(*o.destination) for o in offered}
            others = frozenset(b.number for b in subject.blocks) - {o.number for o in offered}
            chosen = rule.choose(subject, goal, others).number
            by_rule = str(chosen) if str(chosen) in costs else ""
            kind, stratum = "block", "map"
        case ArrowView():
            costs = {str(o.number): o.length_m + left_m(*o.end) for o in subject.arrows}
            if subject.may_turn:
                costs[str(TURN_AROUND)] = left_m(*here.xy) + _TURN_M
            kind, stratum = "arrow", "view"
        case GuideView():
            costs = {
                str(direction): _by_way_of(subject.observation, columns, left_m)
                for direction, columns in subject.windows.items()
            }
            costs[str(Direction.EXPLORE)] = left_m(*here.xy) + _TURN_M
            kind, stratum = "direction", "view"
    right = best_of(costs) if costs else frozenset[str]()
    if len(right) == len(costs):
        return None
    return ExamQuestion(
        sheet.question_id(step, kind, stratum, goal),
        kind,
        stratum,
        sheet.scene,
        goal,
        subject,
        costs=costs,
        right=right,
        rule=by_rule,
        conditions={"distance_m": left_m(*here.xy)},
    )


def _by_way_of(observation: Observation, columns: slice, left_m: PathLeft) -> float:
    """True length of the path by way of floor ahead in these image columns, metres."""
    camera, robot = observation.camera, observation.robot
    middle = (columns.start + columns.stop) // 2
    heading = robot.yaw - math.atan2(middle + 0.5 - camera.cx, camera.fx)
    free_m = 0.8 * float(observation.farthest_m[columns].max())
    ahead_m = min(_AHEAD_M, free_m) if free_m > 0.0 else _AHEAD_M
    x, y = robot.x + ahead_m * math.cos(heading), robot.y + ahead_m * math.sin(heading)
    return ahead_m + left_m(x, y)
