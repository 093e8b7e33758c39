"""Whole searches through a model server that tells the simulator's truth, and fails as told."""

import math
from collections.abc import Iterator
from pathlib import Path

import pytest

from hypernav.app.build.agents import build_agent
from hypernav.app.build.built_agent import BuiltAgent
from hypernav.app.build.components.component_specs import ComponentSpecs, PresetName
from hypernav.core.episode import Outcome
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import StepTrace, without_timings
from hypernav.lab.episodes.episode_run import EpisodeResult, EpisodeRun
from servers.scripted import Failure, ScriptedServer
from servers.truth import Errors, Truth, TruthfulBrain, watching
from small_episodes import episode_from
from small_worlds import small_config, two_rooms

START = Pose2(2.5, 1.0, math.pi / 2)
FAR = Pose2(1.5, 3.0, math.pi)
BED = Goal("bed")
QUICK = {"timeout_s": 5.0, "patience_s": 10.0, "first_wait_s": 0.01, "longest_wait_s": 0.1}
NO_FAULTS: dict[Failure, float] = {}
FAULTS: dict[Failure, float] = {
    "429": 0.03,
    "500": 0.03,
    "reset": 0.02,
    "half": 0.01,
    "broken json": 0.01,
}


@pytest.fixture(scope="module")
def one_server() -> Iterator[ScriptedServer]:
    with ScriptedServer() as server:
        yield server


@pytest.fixture
def server(one_server: ScriptedServer) -> Iterator[ScriptedServer]:
    one_server.reset()
    with watching(Truth()) as truth:
        one_server.brain = TruthfulBrain(truth)
        yield one_server


def agent_on(
    vlm: str, preset: PresetName = "default", record: Path | None = None, **more
) -> BuiltAgent:
    config = small_config(preset, chat={**QUICK, **more})
    return build_agent(config, ComponentSpecs(vlm=vlm), record=record)


def search(
    parts: BuiltAgent, max_steps: int = 150, start: Pose2 = START
) -> tuple[list[StepTrace], EpisodeResult]:
    episode = EpisodeRun(parts.agent, two_rooms(), episode_from(start, BED, max_steps=max_steps))
    return [step.trace for step in episode], episode.result()


def bend(server: ScriptedServer, errors: Errors) -> None:
    assert isinstance(server.brain, TruthfulBrain)
    server.brain.errors = errors


@pytest.mark.parametrize("preset", ["default", pytest.param("paper", marks=pytest.mark.slow)])
def test_a_truthful_model_finds_what_ground_truth_finds(server: ScriptedServer, preset: PresetName):
    starts = [START, Pose2(1.5, 3.0, 0.0), Pose2(4.0, 1.0, math.pi)]
    asked = [search(agent_on(server.spec, preset), start=start) for start in starts]
    told = [search(build_agent(small_config(preset)), start=start) for start in starts]
    for _, result in asked + told:
        assert result.outcome is Outcome.FOUND
    # They choose among the same blocks by other rules, so each path differs.
    asked_spl, told_spl = (sum(r.metrics.spl for _, r in runs) for runs in (asked, told))
    assert asked_spl > 0.8 * told_spl
    kinds = {exchange.kind for step in asked[0][0] for exchange in step.exchanges}
    assert {"ground", "choose block", "verify"} <= kinds


def test_the_ledger_and_the_trace_tell_the_same(server: ScriptedServer):
    parts = agent_on(server.spec, "paper")
    steps, result = search(parts)
    report = parts.take_report()
    exchanges = [one for step in steps for one in step.exchanges if one.by_model]
    total = report["ledger"]["total"]
    assert result.model_calls == total["calls"] == len(exchanges) == len(server.requests)
    assert total["tokens_in"] == sum(one.tokens_in for one in exchanges) > 0
    assert total["tokens_out"] == sum(one.tokens_out for one in exchanges) > 0
    for kind, row in report["ledger"]["kinds"].items():
        assert row["calls"] == sum(one.kind == kind for one in exchanges)
    assert report["fallbacks"]["geometric_choices"] == 0


def test_every_report_begins_at_zero(server: ScriptedServer):
    parts = agent_on(server.spec)
    search(parts, max_steps=3)
    assert parts.take_report()["ledger"]["total"]["calls"] > 0
    assert parts.take_report()["ledger"]["total"]["calls"] == 0


@pytest.mark.slow
def test_transport_faults_lose_nothing_and_change_nothing(server: ScriptedServer):
    traces = []
    for rates in (NO_FAULTS, FAULTS):
        server.rates = rates
        parts = agent_on(server.spec)
        steps, result = search(parts)
        assert result.outcome is Outcome.FOUND
        traces.append([without_timings(step.model_dump(mode="json")) for step in steps])
    total = parts.take_report()["ledger"]["total"]
    assert traces[0] == traces[1]
    assert total["retries"] == len(server.failures) - server.failures.count("ok") > 0
    assert total["lost"] == {"transport": total["retries"]}


@pytest.mark.slow
def test_over_many_starts_faults_lose_no_episode(server: ScriptedServer):
    """With 10% transport faults as many are found as with none, and as with ground truth."""
    outcomes: dict[str, list[Outcome]] = {"truth": [], "model": [], "faulty model": []}
    for number in range(6):
        start = Pose2(1.5 + 0.25 * number, 2.0, number * 0.7)
        for name in outcomes:
            server.rates = FAULTS if name == "faulty model" else NO_FAULTS
            parts = build_agent(small_config()) if name == "truth" else agent_on(server.spec)
            episode = EpisodeRun(parts.agent, two_rooms(), episode_from(start, BED, max_steps=150))
            list(episode)
            outcomes[name].append(episode.result().outcome)
    assert outcomes["model"] == outcomes["faulty model"]
    found = {name: each.count(Outcome.FOUND) for name, each in outcomes.items()}
    assert found["model"] >= found["truth"] == 6
    assert len(server.failures) - server.failures.count("ok") > 10


def test_a_careless_model_still_finds_the_bed(server: ScriptedServer):
    bend(server, Errors(miss=0.2, prose=0.5, truncate=0.1, jitter_px=1.0, babble=0.1))
    steps, result = search(agent_on(server.spec))
    assert result.outcome is Outcome.FOUND
    assert any(one.remarks for step in steps for one in step.exchanges)


@pytest.mark.slow
def test_a_wrong_coordinate_space_is_seen_in_trace_and_report(server: ScriptedServer):
    bend(server, Errors(wrong_space=1.0))
    parts = agent_on(server.spec)
    steps, _ = search(parts)
    assert parts.take_report()["fallbacks"]["rejected_boxes"]["outside the picture"] > 0
    remarks = [mark for step in steps for one in step.exchanges for mark in one.remarks]
    assert any("outside the picture" in remark for remark in remarks)


def test_another_label_is_seen_in_the_trace(server: ScriptedServer):
    bend(server, Errors(wrong_label=1.0))
    steps, _ = search(agent_on(server.spec))
    labels = {found.label for step in steps for found in step.detections}
    assert labels == {"window curtain"}


def test_a_babbling_model_falls_back_and_is_counted(server: ScriptedServer):
    server.personality.honours = ()
    bend(server, Errors(babble=1.0))
    trusting = small_config(chat=QUICK, presence={"unsure": "yes"})
    parts = build_agent(trusting, ComponentSpecs(vlm=server.spec))
    steps, result = search(parts)
    report = parts.take_report()
    assert result.outcome is Outcome.FOUND
    assert report["fallbacks"]["geometric_choices"] > 0
    assert report["fallbacks"]["unsure_presence_checks"] > 0
    faults = [one.fault for step in steps for one in step.exchanges if one.fault]
    assert report["ledger"]["total"]["faults"] == {"unparsable": len(faults)}


@pytest.mark.slow
def test_a_model_that_cannot_say_yes_has_not_found_the_goal(server: ScriptedServer):
    server.personality.honours = ()
    bend(server, Errors(babble=1.0))
    parts = agent_on(server.spec)
    _, result = search(parts)
    assert result.outcome is Outcome.NOT_FOUND
    assert parts.take_report()["fallbacks"]["unsure_presence_checks"] > 0


@pytest.mark.slow
def test_the_search_is_as_good_as_the_model_that_reads_the_map(server: ScriptedServer):
    """The scripted model names the block on the true shortest path, or as often another."""
    lengths_m = {}
    for wrong in (0.0, 1.0):
        bend(server, Errors(wrong_block=wrong))
        runs = [search(agent_on(server.spec), start=start)[1] for start in (START, FAR)]
        lengths_m[wrong] = sum(run.metrics.path_length_m for run in runs)
    assert lengths_m[0.0] <= lengths_m[1.0]


def test_a_model_that_denies_the_goal_has_the_place_rejected(server: ScriptedServer):
    truthful = server.brain

    def denying(asked):
        return "no" if asked.kind == "verify" else truthful(asked)

    server.brain = denying
    steps, result = search(agent_on(server.spec))
    events = [event for step in steps for event in step.events]
    assert result.outcome is Outcome.NOT_FOUND
    assert events.count("goal area rejected") == 1
    reasons = {found.reason for step in steps for found in step.detections}
    assert "rejected before" in reasons


def test_a_recorded_search_replays_to_the_same_trace(server: ScriptedServer, tmp_path: Path):
    bend(server, Errors(miss=0.2, prose=0.5))
    path = tmp_path / "run.jsonl"
    recorded = agent_on(server.spec, record=path)
    first, _ = search(recorded)
    recorded.close()
    asked = len(server.requests)
    replayed = agent_on(f"replay:{path}")
    second, _ = search(replayed)
    assert len(server.requests) == asked
    traces = [[step.model_dump(mode="json") for step in steps] for steps in (first, second)]
    assert [without_timings(step) for step in traces[0]] == [
        without_timings(step) for step in traces[1]
    ]
    waits = [[one.seconds for step in steps for one in step.exchanges] for steps in (first, second)]
    assert waits[0] == waits[1]
    assert replayed.take_report() == recorded.take_report()


def test_a_server_that_dies_ends_the_search_within_the_patience():
    with ScriptedServer() as server, watching(Truth()) as truth:
        server.brain = TruthfulBrain(truth)
        parts = agent_on(server.spec, "paper", patience_s=2.0)
        episode = EpisodeRun(parts.agent, two_rooms(), episode_from(START, BED, max_steps=150))
        seen = []
        for step in episode:
            seen.append(step.trace)
            if len(seen) == 5:
                server.stop()
        result = episode.result()
    assert (result.outcome, result.steps, len(seen)) == (Outcome.MODEL_UNAVAILABLE, 5, 5)
    assert "patience of 2 s" in result.detail
    assert not result.metrics.success
    assert parts.take_report()["ledger"]["total"]["faults"] == {"unavailable": 1}
    assert all(step.exchanges for step in seen)


@pytest.mark.slow
def test_a_server_that_is_restarted_in_time_loses_nothing():
    with ScriptedServer() as server, watching(Truth()) as truth:
        server.brain = TruthfulBrain(truth)
        traces = []
        for restarts in (0, 1):
            parts = agent_on(server.spec)
            steps = []
            for step in EpisodeRun(
                parts.agent, two_rooms(), episode_from(START, BED, max_steps=150)
            ):
                steps.append(without_timings(step.trace.model_dump(mode="json")))
                if restarts and len(steps) == 5:
                    server.stop()
                    server.start()
            traces.append(steps)
    assert traces[0] == traces[1]
    assert "goal reached" in traces[0][-1]["events"]
