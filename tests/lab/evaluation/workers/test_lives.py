"""Lives in a worker: goals one after the other, with a memory that is kept or emptied."""

import json
from contextlib import closing
from dataclasses import replace
from typing import ClassVar

import pytest

from eval_runs import write_room
from hypernav.app.build.agents import build_agent
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.core.embodiment import Action
from hypernav.core.episode import Life, Outcome
from hypernav.core.errors import ModelUnavailableError, WorldError
from hypernav.core.geometry.transforms import Pose2
from hypernav.lab.evaluation.workers.job import Job
from hypernav.lab.evaluation.workers.worker import EpisodeWorker
from small_episodes import episode_from
from small_worlds import small_config

START = Pose2(2.5, 1.0, 0.0)
GOALS = ("bed", "sofa", "bed")


class Listening:
    """Does what it is told for each goal; notes which memory it was given."""

    def __init__(self, actions):
        self.actions, self.goals, self.given = actions, [], []
        self.memory = None

    def reset(self, goal, memory=None):
        self.memory = memory or [goal.text]
        self.goals.append(goal.text)
        self.given.append(memory)
        self._left = list(self.actions[len(self.goals) - 1])

    def act(self, observation):
        action = self._left.pop(0)
        if isinstance(action, Exception):
            raise action
        return action


def life_in(folder, goals=GOALS, **values):
    room = str(write_room(folder / "room.glb"))
    first = replace(episode_from(START, **values), scene_id=room, life="a")
    named = [
        replace(episode_from(START, goal), episode_id=f"a.{k}") for k, goal in enumerate(goals)
    ]
    return Life(tuple(replace(first, episode_id=one.episode_id, goal=one.goal) for one in named))


def lived(folder, life, agent, **job):
    job = Job(folder, small_config(), make_agent=lambda: agent, **job)
    with closing(EpisodeWorker(job)) as worker:
        return worker.live(life)


GO, STOP = [Action.MOVE_FORWARD, Action.STOP], [Action.STOP]


def test_each_goal_begins_where_the_robot_stands_with_what_it_knows(tmp_path):
    agent = Listening([GO, STOP, GO])
    first, second, third = lived(tmp_path, life_in(tmp_path), agent)
    assert agent.goals == list(GOALS)
    assert agent.given == [None, ["bed"], ["bed"]]
    assert [r.goal_number for r in (first, second, third)] == [1, 2, 3]
    assert third.shortest_path_m == first.distance_to_goal_m < first.shortest_path_m
    assert second.path_length_m == 0.0


@pytest.mark.parametrize(
    ("fresh", "told"),
    [
        (False, [None, {"earlier_searches": 1}, {"earlier_searches": 2}]),
        (True, [None, None, None]),
    ],
)
def test_results_of_a_life_tell_how_often_the_robot_had_been_there(tmp_path, fresh, told):
    agent = Listening([STOP, STOP, STOP])
    life = life_in(tmp_path)
    records = lived(tmp_path, life, agent, fresh_memory=fresh, save="videos")
    results = [json.loads((tmp_path / one.saved / "result.json").read_text()) for one in records]
    assert [one.get("memory") for one in results] == told


def test_with_a_fresh_memory_a_goal_is_an_episode_that_starts_there(tmp_path):
    agent = Listening([GO, GO, GO])
    records = lived(tmp_path, life_in(tmp_path), agent, fresh_memory=True)
    assert agent.given == [None, None, None]
    kept = Listening([GO, GO, GO])
    assert [r.shortest_path_m for r in records] == pytest.approx(
        [r.shortest_path_m for r in lived(tmp_path, life_in(tmp_path), kept)]
    )


def test_an_agent_without_memory_lives_too(tmp_path):
    class Forgets:
        def reset(self, goal):
            pass

        def act(self, observation):
            assert observation.robot == Pose2(0.0, 0.0, 0.0)
            return Action.STOP

    assert [r.stopped for r in lived(tmp_path, life_in(tmp_path), Forgets())] == [True] * 3


def test_the_steps_of_a_life_are_counted_together(tmp_path):
    turns = [Action.TURN_LEFT] * 9
    agent = Listening([[*turns[:2], Action.STOP], turns, turns])
    records = lived(tmp_path, life_in(tmp_path, max_steps=4, max_life_steps=6), agent)
    assert [r.steps for r in records] == [3, 3, 0]
    assert [r.outcome for r in records[1:]] == [Outcome.NOT_FOUND] * 2
    assert all(r.counts for r in records)
    assert records[2].why == "the steps of its life had been used up before this goal"


def test_an_agent_that_plans_with_its_steps_is_told_how_many_are_left(tmp_path):
    class Planning(Listening):
        allowed: ClassVar[list[int]] = []

        def allow_steps(self, most):
            self.allowed.append(most)

    agent = Planning([[Action.TURN_LEFT] * 2 + STOP, STOP, STOP])
    lived(tmp_path, life_in(tmp_path, max_steps=4, max_life_steps=6), agent)
    assert agent.allowed == [4, 3, 2]


def test_an_agent_whose_reset_takes_no_memory_lives_without_one(tmp_path):
    class HasAnotherMemory:
        memory = "its own affair"

        def reset(self, goal):
            pass

        def act(self, observation):
            assert observation.robot == Pose2(0.0, 0.0, 0.0)
            return Action.STOP

    records = lived(tmp_path, life_in(tmp_path), HasAnotherMemory())
    assert [r.stopped for r in records] == [True] * 3


@pytest.mark.parametrize(
    ("error", "outcome"),
    [(ModelUnavailableError("away"), Outcome.MODEL_UNAVAILABLE)],
)
def test_an_outage_ends_the_life_and_none_of_its_other_goals_counts(tmp_path, error, outcome):
    records = lived(tmp_path, life_in(tmp_path), Listening([STOP, [error], STOP]))
    assert [r.outcome for r in records[1:]] == [outcome] * 2
    assert [r.counts for r in records] == [True, False, False]
    assert records[2].why == "goal 2 of its life ended it: away"


def test_a_fault_of_the_simulator_ends_the_life(tmp_path, monkeypatch):
    def broken(self, episode):
        raise WorldError("out of order")

    monkeypatch.setattr("hypernav.simulator.worlds.simulation.SimulatedWorld.go_on", broken)
    records = lived(tmp_path, life_in(tmp_path), Listening([STOP, STOP, STOP]))
    assert [r.outcome for r in records[1:]] == [Outcome.SIMULATOR_ERROR] * 2
    assert [r.episode_id for r in records] == ["a.0", "a.1", "a.2"]


@pytest.mark.slow
def test_the_memory_makes_no_difference_to_the_first_goal_but_to_the_others(tmp_path):
    life, config = life_in(tmp_path), small_config()

    def measured(**job):
        agent = build_agent(config, ComponentSpecs()).agent
        records = lived(tmp_path, life, agent, **job)
        return [r.model_dump(exclude={"seconds"}) for r in records]

    kept, fresh = measured(), measured(fresh_memory=True)
    assert kept[0] == fresh[0]
    assert kept[1:] != fresh[1:]


def test_the_same_life_gives_the_same_records(tmp_path):
    life, config = life_in(tmp_path), small_config()
    agent = build_agent(config, ComponentSpecs()).agent
    first, again = (
        [r.model_dump(exclude={"seconds"}) for r in lived(tmp_path, life, agent)] for _ in range(2)
    )
    assert first == again


def test_only_the_record_of_a_life_names_one(tmp_path):
    (record,) = lived(tmp_path, life_in(tmp_path, goals=["bed"]), Listening([STOP]))
    assert '"life":"a","goal_number":1' in record.model_dump_json()
    alone = record.model_copy(update={"life": ""}).model_dump_json()
    assert '"life":' not in alone
    assert '"goal_number":' not in alone
