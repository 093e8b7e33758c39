"""Runs lives in a worker: one agent, and one scene at a time."""

import hashlib
import re
from collections import Counter
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from hypernav.app.build.worlds import open_world
from hypernav.core.components.abilities import BeginsMemory, Closes, PlansSteps, remembers
from hypernav.core.components.door import SIMULATOR_ERRORS
from hypernav.core.episode import Episode, Life, Outcome
from hypernav.core.geometry.transforms import Transform
from hypernav.core.trace import Ending, StepTrace
from hypernav.core.world import Simulator
from hypernav.io.writing import own_folder
from hypernav.lab.episodes.episode_run import EpisodeResult, EpisodeRun, EpisodeStep
from hypernav.lab.episodes.object_distance import object_distance
from hypernav.lab.episodes.recorder import EpisodeRecorder
from hypernav.lab.episodes.storyboard import Image, Storyboard
from hypernav.lab.evaluation.failure_evidence import FailureEvidence, decisive_step
from hypernav.lab.evaluation.failures import Verdict, classify
from hypernav.lab.evaluation.record import EpisodeRecord, unmeasured_record
from hypernav.lab.evaluation.store.run_store import SAVED_FOLDER
from hypernav.lab.evaluation.workers.job import Job
from hypernav.lab.evaluation.workers.searcher import searcher_of
from hypernav.search.perception.exchanges import unusable_answers

_NO_STEPS_LEFT = "the steps of its life had been used up before this goal"


class EpisodeWorker:
    """Runs lives one after another. A scene stays loaded until another one is needed.

    Drawing is most of the work, so colours are drawn only when they are needed. If the agent needs
    none and only failures are saved, episodes run without colours, which are drawn afterwards for
    the frames of a failed episode.
    """

    def __init__(self, job: Job) -> None:
        """Build the agent.

        Raises:
            HyPerNavError: The agent can't be built.
        """
        self._job = job
        self._searcher = searcher_of(job.config, job.specs, job.make_agent)
        self._scene: _OpenScene | None = None

    def run(self, episode: Episode) -> EpisodeRecord:
        """Run one episode that belongs to no life, as `live` does."""
        return self.live(Life((episode,)))[0]

    def live(self, life: Life) -> list[EpisodeRecord]:
        """Run the searches of a life one after another.

        The robot goes on where it stands. With a memory its map frame stays, too; without one, as
        with ``fresh_memory`` or an agent that has none, a new one begins there.

        Errors of the simulator become part of a record. They and outages of a model end the life:
        its other goals have the same outcome. Every other error means that the run itself can't go
        on.

        Returns:
            The records of all goals.

        Raises:
            ComponentError: A component of the user's own failed.
            HyPerNavError: The agent can't search for a goal, or page or video can't be written.
        """
        rng = np.random.default_rng(life.episodes[0].seed(self._job.seed))
        records: list[EpisodeRecord] = []
        steps_left = life.max_steps
        for number, episode in enumerate(life.episodes, start=1):
            limited = replace(episode, max_steps=min(episode.max_steps, steps_left))
            record = self._search(limited, number, rng)
            if steps_left == 0:
                record = record.model_copy(update={"why": _NO_STEPS_LEFT})
            steps_left -= record.steps
            records.append(record)
            if not record.counts:
                why = f"goal {number} of its life ended it: {record.why}"
                rest = life.episodes[number:]
                records += [
                    unmeasured_record(other, record.outcome, why, goal_number=at)
                    for at, other in enumerate(rest, start=number + 1)
                ]
                break
        return records

    def _search(self, episode: Episode, number: int, rng: np.random.Generator) -> EpisodeRecord:
        """Search for the goal of a life that has this number, from 1."""
        try:
            scene = self._scene_of(episode.scene_id)
            scene.world.colours = self._searcher.looks_at_colours or self._job.save == "videos"
            agent, memory = self._searcher.agent, None
            if isinstance(agent, PlansSteps):
                agent.allow_steps(episode.max_steps)
            keeps_memory = not self._job.fresh_memory and remembers(agent)
            goes_on = number > 1 and keeps_memory
            if episode.life and number == 1 and keeps_memory and isinstance(agent, BeginsMemory):
                memory = agent.new_memory()
            if number > 1 and not goes_on:
                truth = scene.world.truth
                episode = replace(episode, start=truth.pose, start_z=truth.position[2])
            run = EpisodeRun(
                agent,
                scene.world,
                episode,
                rng=rng,
                told=self._searcher.truth,
                memory=memory,
                goes_on=goes_on,
            )
            return self._watch(run, scene, number, goes_on=goes_on)
        except SIMULATOR_ERRORS as error:
            said = f"{type(error).__name__}: {error}"
            return unmeasured_record(episode, Outcome.SIMULATOR_ERROR, said, goal_number=number)

    def close(self) -> None:
        """Close scene and agent; no episode is run afterwards."""
        self._leave_scene()
        if isinstance(self._searcher.whole, Closes):
            self._searcher.whole.close()

    def _leave_scene(self) -> None:
        if self._scene is not None:
            self._scene.world.close()
        self._scene = None

    def _scene_of(self, scene_id: str) -> "_OpenScene":
        if self._scene is None or self._scene.scene_id != scene_id:
            self._leave_scene()  # frees the old scene's memory before the new one is loaded
            config, world = self._job.config, self._job.world
            if isinstance(world, str):
                opened = open_world(scene_id, config, world, threads=1)
            else:
                opened = world(scene_id, config)
            self._scene = _OpenScene(scene_id, opened)
        return self._scene

    def _watch(
        self, run: EpisodeRun, scene: "_OpenScene", number: int, *, goes_on: bool
    ) -> EpisodeRecord:
        before = {"memory": {"earlier_searches": number - 1}} if goes_on else {}
        episode, world, save = run.trial.episode, scene.world, self._job.save
        truth = world.truth
        goal = truth.goal_truth(episode.goal, episode.view_points)
        evidence = FailureEvidence(truth, goal, self._job.config)
        questions, tokens, unusable = Counter[str](), Counter[str](), Counter[str]()
        storyboard = Storyboard(truth.camera_to_scene)
        saved = ""
        with self._recorder(episode) if save == "videos" else nullcontext() as recorder:
            for step in run:
                evidence.watch(step)
                _count(step, questions, tokens)
                unusable += unusable_answers(step.trace)
                if recorder is not None:
                    recorder.add(step.trace, step.grid, step.observation)
                elif save == "failures":
                    storyboard.watch(step, truth.camera_to_scene, coloured=world.colours)
            result = run.result()
            stopped = run.trial.ending is Ending.FOUND
            facts = evidence.facts(
                result, stopped=stopped, success_distance_m=episode.success_distance_m
            )
            verdict = classify(facts)
            if recorder is not None:
                saved = self._finish(recorder, episode, result, verdict, before)
        if save == "failures" and verdict is not None:
            with self._recorder(episode) as recorder:
                storyboard.record(recorder, scene.image_from)
                saved = self._finish(recorder, episode, result, verdict, before)
        return EpisodeRecord(
            scene_id=episode.scene_id,
            episode_id=episode.episode_id,
            goal=episode.goal.text,
            group=episode.group,
            outcome=result.outcome,
            failure=verdict.failure if verdict is not None else None,
            why=verdict.why if verdict is not None else "",
            **result.measures(),
            distance_to_object_m=object_distance(truth, goal.instances, truth.position),
            stopped=stopped,
            steps=result.steps,
            model_calls=result.model_calls,
            questions=dict(sorted(questions.items())),
            unusable_answers=dict(sorted(unusable.items())),
            tokens_in=tokens["in"],
            tokens_out=tokens["out"],
            saved=saved,
            life=episode.life,
            goal_number=number,
            seconds={module: round(value, 4) for module, value in result.seconds.items()},
        )

    def _recorder(self, episode: Episode) -> EpisodeRecorder:
        return EpisodeRecorder(
            own_folder(self._job.folder, SAVED_FOLDER, folder_name(episode)),
            goal=episode.goal.text,
            agent=self._searcher.words["agent"],
            detector=self._searcher.words["detector"],
            reasoner=self._searcher.words["reasoner"],
            step_limit=episode.max_steps,
        )

    def _finish(
        self,
        recorder: EpisodeRecorder,
        episode: Episode,
        result: EpisodeResult,
        verdict: Verdict | None,
        before: dict[str, Any],
    ) -> str:
        """Complete the episode's folder; returns its path within the run's."""
        recorder.finish(
            {
                "goal": episode.goal.text,
                "scene": episode.scene_id,
                "episode": episode.episode_id,
                **self._searcher.words,
                **before,
                "outcome": result.outcome.value,
                "failure": verdict.failure.words if verdict is not None else "",
                "why": verdict.why if verdict is not None else "",
                **_decisive_step(verdict, recorder.steps),
                "steps": result.steps,
                "max_steps": episode.max_steps,
                "model_calls": result.model_calls,
                **result.measures(),
                "seconds": {module: round(s, 3) for module, s in result.seconds.items()},
                "config": self._job.config.model_dump(mode="json"),
            }
        )
        return recorder.folder.relative_to(self._job.folder).as_posix()


def _decisive_step(verdict: Verdict | None, steps: Sequence[StepTrace]) -> dict[str, int]:
    """The step at which the page of a failed episode opens; None for other episodes."""
    if verdict is None or not steps:
        return {}
    return {"decisive_step": decisive_step(verdict.failure, steps)}


@dataclass(frozen=True, eq=False)
class _OpenScene:
    """An open scene, and the world in it."""

    scene_id: str
    world: Simulator

    def image_from(self, camera_to_scene: Transform) -> Image:
        """What the camera sees from a true pose, in colours."""
        return self.world.truth.view_from(camera_to_scene).rgb


def folder_name(episode: Episode) -> str:
    """A unique name for an episode's folder that every file system accepts."""
    key = hashlib.sha256(repr(episode.key).encode()).hexdigest()[:8]
    scene = Path(episode.scene_id).stem if "/" in episode.scene_id else episode.scene_id
    text = f"{scene}-{episode.episode_id}-{episode.goal.text}".lower()
    return f"{re.sub(r'[^a-z0-9]+', '-', text).strip('-')[:110]}-{key}"


def _count(step: EpisodeStep, questions: Counter[str], tokens: Counter[str]) -> None:
    for exchange in step.trace.exchanges:
        questions[exchange.kind] += 1
        tokens["in"] += exchange.tokens_in
        tokens["out"] += exchange.tokens_out
