import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

from box_scenes import room_boxes, scene_of
from hypernav.app.build.agents import build_search
from hypernav.app.build.components.component_specs import PresetName
from hypernav.core.components.protocols import Agent, ExplainsItself
from hypernav.core.embodiment import Action
from hypernav.core.episode import Outcome
from hypernav.core.errors import WorldError
from hypernav.core.exploring.exploration import Destination
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import Ending, ExchangeLog, Mode, without_timings
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.search.agents.plan import Endurance, Plan
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector
from small_episodes import episode_from
from small_worlds import colourless_world, small_config, two_rooms

START = Pose2(2.5, 1.0, math.pi / 2)


def search(agent="hypernav", name: PresetName = "default", detector=None, **sections):
    config = small_config(name, **sections)
    return build_search(config, detector or GroundTruthDetector(), ExchangeLog(), agent=agent)


def run(agent, goal, start=START, **options):
    episode = EpisodeRun(agent, two_rooms(coloured=False), episode_from(start, goal, **options))
    return [step.trace for step in episode], episode.result()


@pytest.mark.parametrize("preset", ["default", "paper"])
@pytest.mark.parametrize("agent", ["hypernav", "frontier"])
def test_it_finds_the_bed_in_the_next_room(agent, preset):
    steps, result = run(search(agent, preset), "bed")
    assert result.outcome is Outcome.FOUND
    assert result.metrics.spl > 0.25
    assert steps[-1].action is Action.STOP


def test_agents_keep_the_contract():
    agent = search()
    assert isinstance(agent, Agent)
    run(agent, "bed", max_steps=1)
    assert isinstance(agent, ExplainsItself)


def test_the_same_search_leaves_the_same_trace():
    agent = search()
    runs = [run(agent, "bed")[0] for _ in range(2)]
    first, second = ([without_timings(s.model_dump(mode="json")) for s in r] for r in runs)
    assert first == second


def test_a_goal_that_is_not_there_is_given_up_when_all_is_explored():
    steps, result = run(search(), "piano")
    assert result.outcome is Outcome.NOT_FOUND
    assert steps[-1].ending is Ending.GAVE_UP
    assert steps[-1].action is None
    assert not result.metrics.success
    assert result.steps < 200
    assert result.detail == "nothing is left to explore"


def test_the_step_limit_ends_a_search():
    steps, result = run(search(), "bed", max_steps=5)
    assert len(steps) == result.steps == 5
    assert result.outcome is Outcome.NOT_FOUND
    assert result.detail == ""


class Stubborn:
    """An explorer that always names a place to which no path leads."""

    def next_destination(self, view):
        return Destination(100.0, 0.0, "far away")


@pytest.mark.parametrize("gives_up", [True, False])
def test_a_search_whose_destinations_lead_nowhere_says_so_at_its_end(gives_up):
    agent = search(f"{__name__}:Stubborn", search={"end_when_explored": gives_up})
    steps, result = run(agent, "bed", max_steps=60)
    assert (steps[-1].ending is Ending.GAVE_UP) == gives_up
    assert result.detail.startswith("no path to destination at (100.0, 0.0) m: far away")


def test_local_perception_beats_global_perception():
    steps, _ = run(search(), "bed")
    seen = next(i for i, step in enumerate(steps) if step.goal_area)
    assert all(step.mode in (Mode.APPROACH, Mode.VERIFY, Mode.STOP) for step in steps[seen:])
    assert all(step.mode in (Mode.EXPLORE, Mode.LOOK_AROUND) for step in steps[:seen])


def test_it_looks_around_first_and_only_if_asked_to():
    for least_unseen_m2, turns in ((None, 12), (1.0, 10)):  # the image is 79 degrees wide
        agent = search(search={"least_unseen_m2": least_unseen_m2})
        steps, _ = run(agent, "piano", max_steps=turns + 1)
        assert [step.mode for step in steps[:-1]] == [Mode.LOOK_AROUND] * turns
        assert steps[-1].mode is Mode.EXPLORE
    steps, _ = run(search(name="paper"), "piano", max_steps=1)
    assert steps[0].mode is Mode.EXPLORE


@pytest.mark.parametrize("preset", ["default", "paper"])
def test_who_looks_at_destinations_only_turns_around_before_every_map_question(preset):
    agent = search(name=preset, search={"looks": "at-destinations"})
    steps, result = run(agent, "bed", max_steps=200)
    assert result.outcome is Outcome.FOUND
    turned = 0
    for step in steps:
        assert turned or not step.detections
        if step.exchanges:
            assert turned == 12
        turned = turned + 1 if step.mode is Mode.LOOK_AROUND else 0


@pytest.mark.parametrize("preset", ["default", "paper"])
@pytest.mark.parametrize(
    "switched",
    [
        {"local": {"pixels": "box"}},
        {"local": {"erosion_px": 1}},
        {"local": {"dilation_iterations": 0}},
        {"overview": {"visited": "none"}},
        {"planning": {"replan_every_steps": None}},
    ],
    ids=str,
)
def test_a_search_without_one_part_finds_a_bed_that_is_easy_to_find(preset, switched):
    _, result = run(search(name=preset, **switched), "bed", max_steps=200)
    assert result.outcome is Outcome.FOUND


def test_every_map_question_is_in_the_trace():
    steps, _ = run(search(), "bed")
    asked = [step for step in steps if step.exchanges]
    assert asked
    for step in asked:
        assert step.exchanges[-1].kind == "choose block"
        assert step.exchanges[-1].chosen in {block.number for block in step.blocks}


class Denies:
    """A presence check that never believes it."""

    def __init__(self):
        self.asked = 0

    def is_present(self, observation, goal):
        self.asked += 1
        return False


def test_a_goal_area_that_is_denied_is_rejected_and_the_search_goes_on():
    denies = Denies()
    agent = build_search(small_config(), GroundTruthDetector(), ExchangeLog(), presence=denies)
    steps, result = run(agent, "sofa", max_steps=150)
    events = [event for step in steps for event in step.events]
    assert denies.asked == events.count("goal area rejected") >= 1
    assert "goal reached" not in events
    assert result.outcome is Outcome.NOT_FOUND


def test_the_endurance_limit_ends_a_destination():
    limits = {"endurance_steps": 3, "give_up_when_stuck": False, "drop_explored": False}
    steps, _ = run(search(search=limits), "piano")
    assert "endurance exceeded" in {event for step in steps for event in step.events}


def bed_gap_m(x, **options):
    """Distance from the bed, metres, of a robot that set out at ``(x, 3)`` and stopped there."""
    steps, _ = run(search(search=options), "bed", Pose2(x, 3.0, 0.0))
    robot = np.array([x, 3.0]) + steps[-1].pose[:2]
    corners = np.array([[7.0, 0.1], [8.9, 1.7]])
    return float(np.linalg.norm(robot - robot.clip(*corners)))


def test_it_stops_in_the_goal_area_and_not_half_a_step_before_it():
    config = small_config()
    reach_m = config.local.entry_reach_m + config.search.stop_distance_m
    starts = (5.5, 5.6, 6.3)
    assert max(bed_gap_m(x) for x in starts) < reach_m
    assert max(bed_gap_m(x, enter_fully=False) for x in starts) > reach_m


def test_who_gets_nowhere_far_from_the_goal_explores_before_trying_again(monkeypatch):
    class WearsOutOnce(Endurance):
        asked = 0

        def after(self, left_m, planned):
            WearsOutOnce.asked += 1
            return self

        @property
        def lasts(self):
            return self.asked != 2

    patience = WearsOutOnce(limit=0)
    monkeypatch.setattr(
        Plan, "with_new_patience", lambda plan, config: plan.approach(patience=patience)
    )
    steps, _ = run(search(search={"endurance_steps": 3, "least_unseen_m2": None}), "bed")
    given_up = [s.step for s in steps if "goal out of reach for now" in s.events]
    assert given_up
    for step in given_up:
        resting = steps[step : step + 3]
        assert Mode.APPROACH not in {s.mode for s in resting}
    assert {Mode.APPROACH, Mode.VERIFY} & {s.mode for s in steps[given_up[0] :]}


def test_who_gets_nowhere_on_the_way_gives_the_destination_up():
    steps, _ = run(search(search={"patience_steps": 0}), "piano", max_steps=60)
    assert "no progress to destination" in {event for step in steps for event in step.events}
    steps, _ = run(search(search={"give_up_when_stuck": False}), "piano", max_steps=60)
    assert "no progress to destination" not in {event for step in steps for event in step.events}


def closet():
    """A closed closet, too narrow to go anywhere in."""
    config = small_config("paper")
    scene = scene_of(*room_boxes(0.6, 0.6), name="closet")
    return colourless_world(scene, config)


@pytest.mark.parametrize("agent", [pytest.param("hypernav", marks=pytest.mark.slow), "frontier"])
def test_the_paper_never_gives_up_before_the_limit(agent):
    steps, result = run(search(agent, "paper"), "piano", max_steps=250)
    assert result.steps == 250
    assert steps[-1].ending is None
    visited = {tuple(step.destination) for step in steps if step.destination}
    assert len(visited) > 3


@pytest.mark.parametrize("agent", ["hypernav", "frontier"])
def test_a_robot_that_can_go_nowhere_turns_on_until_the_limit(agent):
    episode = EpisodeRun(
        search(agent, "paper"),
        closet(),
        episode_from(Pose2(0.3, 0.3, 0.0), "piano", max_steps=60),
    )
    steps = [step.trace for step in episode]
    assert len(steps) == 60
    assert all(step.action is Action.TURN_LEFT for step in steps)
    # A question a circle, not one a step.
    assert sum(len(step.exchanges) > 0 for step in steps) <= 6


def test_a_goal_that_is_not_reached_in_time_is_given_up_for_now():
    limits = {"endurance_steps": 2, "give_up_when_stuck": False, "local_first": True}
    local = {"target": "latest", "rejected_for_looks": 5}
    steps, _ = run(search(search=limits, local=local), "bed")
    given_up = [step.step for step in steps if "goal area given up for now" in step.events]
    assert given_up
    after = steps[given_up[0] + 1 : given_up[0] + 5]
    assert Mode.APPROACH not in {step.mode for step in after}
    assert Mode.APPROACH in {step.mode for step in steps[given_up[0] + 5 :]}


def test_an_agent_that_has_not_acted_has_no_trace():
    agent = search()
    agent.reset(Goal("bed"))
    with pytest.raises(WorldError, match=r"reset\(goal\), then act"):
        _ = agent.last_step


class DoubtfulDetector:
    """Is never sure, and takes the sofa for a bed from one half of the room."""

    score_weights = GroundTruthDetector.score_weights

    def detect(self, observation, goal):
        truth = GroundTruthDetector()
        beds, sofas = truth.detect(observation, goal), truth.detect(observation, Goal("sofa"))
        fooled = observation.robot.y < 1.0
        return [
            *(replace(one, score=0.6) for one in beds),
            *(replace(one, score=0.6, is_goal=fooled) for one in sofas),
        ]


def events_of(steps):
    return [event for step in steps for event in step.events]


@pytest.mark.parametrize(
    ("target", "outcome"), [("latest", "wrong_place"), ("candidates", "found")]
)
def test_a_second_look_from_another_side_unmasks_a_sofa(target, outcome):
    agent = search(detector=DoubtfulDetector(), local={"target": target})
    steps, result = run(agent, "bed")
    assert result.outcome == outcome
    assert ("second look wanted" in events_of(steps)) == (target == "candidates")
    assert ("goal area rejected" in events_of(steps)) == (target == "candidates")


@dataclass
class SeesItFromOneSideOnly:
    """Takes the sofa for a bed from one half of the room, and sees nothing from the other."""

    score: float

    def detect(self, observation, goal):
        if goal.text != "bed" or observation.robot.y >= 1.0:
            return []
        sofas = GroundTruthDetector().detect(observation, Goal("sofa"))
        return [replace(one, score=self.score) for one in sofas]


@pytest.mark.parametrize(("score", "squeeze_m"), [(0.5, 0.04), (0.7, 0.0), (0.95, 0.04)])
def test_it_does_not_stop_on_one_view_however_wide_its_paths_are(score, squeeze_m):
    planning = {"squeeze_m": squeeze_m}
    steps, _ = run(search(detector=SeesItFromOneSideOnly(score), planning=planning), "bed")
    assert "second look wanted" in events_of(steps)


def test_what_a_second_look_does_not_show_is_not_believed():
    agent = search(detector=SeesItFromOneSideOnly(score=0.3))
    steps, _ = run(agent, "bed")
    assert "second look wanted" in events_of(steps)
    assert steps[-1].ending is Ending.GAVE_UP


class FaintDetector:
    """Sees the bed, but hardly believes it."""

    score_weights = GroundTruthDetector.score_weights

    def detect(self, observation, goal):
        beds = GroundTruthDetector().detect(observation, goal)
        return [replace(one, score=0.25) for one in beds]


def test_the_last_steps_belong_to_the_likeliest_candidate():
    agent = search(detector=FaintDetector(), search={"max_steps": 60})
    steps, _ = run(agent, "bed", max_steps=60)
    assert steps[-1].ending is Ending.FOUND


def test_who_is_told_of_fewer_steps_takes_its_last_chance_earlier_and_forgets_them_again():
    agent = search(detector=FaintDetector(), search={"max_steps": 400})
    agent.allow_steps(60)
    steps, _ = run(agent, "bed", max_steps=60)
    assert steps[-1].ending is Ending.FOUND
    agent.allow_steps(10_000)
    assert agent.components.config.max_steps == 400


@pytest.mark.parametrize(("look_again", "circles"), [(True, 2), (False, 1)])
def test_it_looks_around_once_more_before_it_gives_up(look_again, circles):
    agent = search(search={"look_again_before_giving_up": look_again})
    steps, result = run(agent, "piano")
    assert result.outcome is Outcome.NOT_FOUND
    turned = sum(step.mode is Mode.LOOK_AROUND for step in steps)
    assert turned >= 10 + 12 * (circles - 1)
    assert look_again or turned == 10


def test_it_may_claim_the_goal_where_it_would_give_up():
    agent = search(search={"claim_when_explored": True, "look_again_before_giving_up": False})
    steps, result = run(agent, "piano")
    assert (steps[-1].action, steps[-1].ending) == (Action.STOP, Ending.FOUND)
    assert result.outcome is not Outcome.FOUND


def marks_of_a_bump(earlier: list[tuple[float, float]]) -> list[list[float]]:
    """What a search marks that bumps in its first step, where an earlier one has driven."""
    agent, world = search(), two_rooms(coloured=False)
    memory = agent.new_memory()
    memory.floor.trajectory = earlier
    agent.reset(Goal("bed"), memory)
    observation = world.reset(episode_from(START))
    while (action := agent.act(observation)) is not Action.MOVE_FORWARD:
        assert action is not None
        observation = world.step(action)
    before = agent.grid.occupied.copy()
    agent.act(observation)
    return agent.grid.centres_of(np.argwhere(agent.grid.occupied & ~before)).tolist()


def test_where_an_earlier_search_drove_may_be_something_now():
    marks = marks_of_a_bump([(9.0, 9.0)])
    assert len(marks) > 3
    assert marks_of_a_bump([(0.0, -0.4), (0.0, 0.0)]) == marks  # past the right of them


def test_an_agent_without_a_goal_says_what_to_do():
    with pytest.raises(WorldError, match=r"call reset\(goal\) first"):
        search().grid  # noqa: B018
    with pytest.raises(WorldError, match=r"call reset\(goal\) first"):
        search().act(two_rooms().reset(episode_from(START)))


def test_stop_says_that_the_goal_is_here_and_giving_up_does_not():
    for goal, action, ending in (
        ("bed", Action.STOP, Ending.FOUND),
        ("piano", None, Ending.GAVE_UP),
    ):
        steps, _ = run(search(), goal)
        assert (steps[-1].action, steps[-1].ending) == (action, ending)
        for step in steps[:-1]:
            assert step.action not in (Action.STOP, None)
            assert step.ending is None


@pytest.mark.parametrize(("number", "told"), [(None, None), (0, 1), (1, 2)])
def test_the_trace_counts_floors_from_one_where_there_are_several(number, told):
    agent, world = search(), two_rooms()
    memory = agent.new_memory()
    observation = world.reset(episode_from(START))
    if number is not None:
        memory.add_floor(3.0 if number == 0 else -3.0)
        memory.floors = memory.floors[:: -1 if number else 1]
        memory.number = number
    agent.reset(Goal("bed"), memory)
    agent.act(observation)
    assert agent.last_step.floor == told
