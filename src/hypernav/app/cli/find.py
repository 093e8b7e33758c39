"""The command `hypernav find`: search for an object and leave a page about the search."""

import math
import re
from contextlib import ExitStack, closing
from dataclasses import asdict
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.markup import escape
from rich.status import Status

from hypernav.app.build.built_agent import BuiltAgent
from hypernav.app.build.memories.building_memory import open_memory
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.app.build.worlds import open_world
from hypernav.app.cli.guards.crashes import ExitStatus, crash_report
from hypernav.app.cli.guards.interruptions import Terminated, interruptions_put_off
from hypernav.app.cli.guards.outputs import check_apart, check_file, check_folder
from hypernav.app.cli.options.agent import check_memory_options, check_steps_and_seed
from hypernav.app.cli.options.commands import FindOptions
from hypernav.app.cli.screen.search_lines import (
    found_start_line,
    live_line,
    no_such_object_line,
    print_result,
    unusable_answers_line,
    warnings_on,
)
from hypernav.app.cli.screen.terminal import Terminal
from hypernav.app.cli.screen.views import (
    Views,
    check_not_written_by_search,
    check_views,
    opened_views,
)
from hypernav.app.show.video_frame import EpisodeInfo
from hypernav.app.warmup.background import warm_up_in_background
from hypernav.core.components.abilities import check_remembers
from hypernav.core.config import check_option
from hypernav.core.episode import MAX_STEPS, Episode, Outcome
from hypernav.core.errors import (
    ConfigError,
    MemoryStartError,
    ModelSetupError,
    ModelUnavailableError,
    OutputError,
)
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.interruptions import interruptions_of_kernels
from hypernav.core.world import Simulator
from hypernav.io.checkout import commit
from hypernav.io.folder_lock import folder_lock
from hypernav.lab.datasets.benchmarks import robot_in
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.lab.episodes.recorder import OUTPUT_FILES, EpisodeRecorder
from hypernav.lab.evaluation.run_cost import kinds_asked, pace_words
from hypernav.search.memory.store.memory_folder import MemoryFolder
from hypernav.simulator.worlds.simulated_robot import check_standable

_FARTHEST = 10_000.0


def run(options: FindOptions) -> int:
    """Run the command.

    Returns:
        The status of success if the goal was found, of failure if not.

    Raises:
        ModelUnavailableError: The model was unavailable; what was done is on disk.
        ModelSetupError: URL, key or name of the model are wrong; what was done is on disk.
        OutputError: Nothing can be written, or the disk is full; earlier output is on disk.
        RunFolderError: Another search writes to the folder, or to that of the memory.
        MemoryFolderError: The memory can't be used.
        MemoryStartError: What the robot sees at the start contradicts the memory.
        KeyboardInterrupt: Ctrl-C or SIGTERM; what was done is on disk.
    """
    check_steps_and_seed(options.max_steps, options.seed)
    check_start(options.start)
    check_memory_options(options)
    goal = Goal(options.goal)
    folder = options.out or _new_folder(goal)
    if options.memory is not None:
        check_apart(folder, options.memory)
    check_folder(folder, OUTPUT_FILES)
    check_views(options.views, folder)
    if options.record is not None:
        check_file(options.record)
        check_not_written_by_search(options.record, folder)
    with crash_report(folder):
        return _find(options, goal, folder)


def _find(options: FindOptions, goal: Goal, folder: Path) -> ExitStatus:
    """Load the building, search, and write the page, even if the search fails."""
    steps = options.max_steps or options.who.step_limit(MAX_STEPS)
    config = options.who.resolve(robot_in(options.scene)).for_steps(steps)
    parts = options.who.build(config, record=options.record)
    parts.check_goal(goal)
    console = Terminal(quiet=options.quiet)
    with (
        closing(parts),
        warnings_on(console),
        warm_up_in_background(console.print),
        console.status("loading the building …") as status,
        closing(open_world(options.scene, config, options.world)) as world,
        ExitStack() as opened,
    ):
        rng = np.random.default_rng(options.seed)
        start, start_z = start_pose(options.start, world, goal, rng)
        episode = Episode(options.scene, "", goal, start, start_z=start_z, max_steps=steps)
        memory, earlier_searches = None, 0
        if options.memory is not None:
            check_remembers(parts.agent)
            memory = opened.enter_context(opened_memory(options, config, console))
            earlier_searches = memory.memory.searches
        search = EpisodeRun(
            parts.agent,
            world,
            episode,
            rng=rng,
            told=parts.truth,
            memory=memory,
            relocalize=options.relocalize,
        )
        opened.enter_context(folder_lock(folder))  # only now: a refusal leaves no folder
        if search.found_start is not None:
            console.print(found_start_line(search.found_start, options.memory), soft_wrap=True)
        if not search.trial.holds_goal:
            labels = [one.label for one in world.truth.instances if one.label is not None]
            console.print(no_such_object_line(goal, labels), soft_wrap=True)
        for warning in parts.warnings:
            console.print(f"[yellow]{escape(warning)}[/]", soft_wrap=True)
        info = EpisodeInfo(
            goal=goal.text,
            agent=options.who.name,
            detector=parts.detector_words,
            reasoner=parts.reasoner_words,
            step_limit=steps,
        )
        # Absolute, since a component of the user's own may change the working directory.
        with (
            EpisodeRecorder(folder.absolute(), **asdict(info)) as recorder,
            opened_views(options.views, info, recorder) as views,
        ):
            stopped_by = _search(search, views, console, status, parts, config)
            status.update("writing the page …")
            with interruptions_put_off():
                early = KeyboardInterrupt | OutputError | MemoryStartError
                is_stopped = isinstance(stopped_by, early)
                outcome = search.result(interrupted=is_stopped and not search.trial.is_over)
                result = {
                    "goal": goal.text,
                    "scene": options.scene,
                    "commit": commit(),
                    **options.who.describe(parts),
                    "seed": options.seed,
                    "max_steps": steps,
                    "holds_goal": search.trial.holds_goal,
                    "start": start_values(start, start_z),
                    **_found_start(search),
                    **_memory_entry(options, search, earlier_searches),
                    **outcome.as_dict(),
                    **parts.take_report(),
                    "config": config.model_dump(mode="json"),
                }
                unwritten = _finish(views, result, console)
                stopped_by = stopped_by or unwritten
                status.stop()
                if not isinstance(stopped_by, ModelSetupError):
                    print_result(console, goal, outcome)
                    if (recorder.folder / "index.html").exists():
                        page = escape(str(folder / "index.html"))
                        console.print(f"  open {page}", soft_wrap=True)
                    unusable = recorder.unusable_answers
                    if line := unusable_answers_line(outcome.model_calls, unusable):
                        console.print(line, soft_wrap=True)
                    if memory is not None and memory.forgotten_words:
                        console.print(memory.forgotten_words, soft_wrap=True)
            if not isinstance(stopped_by, Terminated | ModelSetupError):
                views.stay(console)
    if stopped_by is not None:
        raise stopped_by
    if outcome.outcome is Outcome.MODEL_UNAVAILABLE:
        raise ModelUnavailableError(outcome.detail)
    return ExitStatus.SUCCESS if outcome.metrics.success else ExitStatus.FAILURE


def opened_memory(options: FindOptions, config: HyPerNavConfig, console: Console) -> MemoryFolder:
    """The memory of ``--memory``; prints what is left out of a damaged one."""
    memory = open_memory(options.memory or "", config, most_megabytes=options.memory_mb)
    for line in memory.left_out:
        console.print(f"[yellow]{escape(line)}[/]", soft_wrap=True)
    return memory


def check_start(start: tuple[float, ...] | None) -> None:
    """Refuse a ``--start`` that is no pose in a building.

    Raises:
        ConfigError: It is not.
    """
    if start is not None and len(start) not in (3, 4):
        raise ConfigError(
            f"--start takes three numbers, X and Y in metres and YAW in degrees, and the height of "
            f"a floor if you like; got {len(start)}: {' '.join(map(str, start)) or 'none'}"
        )
    for number in start or ():
        check_option("--start", number, (-_FARTHEST, _FARTHEST), "metres or degrees in a building")


def start_pose(
    start: tuple[float, ...] | None, world: Simulator, goal: Goal, rng: np.random.Generator
) -> tuple[Pose2, float | None]:
    """The pose of ``--start``, or a random one from which the goal can be reached.

    Returns:
        The pose, and the height of its floor in metres, where one is given.

    Raises:
        StartError: The robot can't stand at the start.
    """
    if start is None:
        return world.truth.random_start(rng, goal), None
    pose, z = given_start(start)
    if z is None:
        check_standable(world.truth.walkable, pose)
    return pose, z


def given_start(start: tuple[float, ...]) -> tuple[Pose2, float | None]:
    """The pose of a ``--start`` that `check_start` took, and the height of its floor if given."""
    x, y, yaw_deg, *z = start
    return Pose2(x, y, math.radians(yaw_deg)), z[0] if z else None


def start_values(start: Pose2, start_z: float | None) -> list[float]:
    """A start as ``--start`` takes it: metres, degrees, and the height of a floor if given."""
    given = () if start_z is None else (start_z,)
    return [start.x, start.y, math.degrees(start.yaw), *given]


def _search(
    search: EpisodeRun,
    views: Views,
    console: Terminal,
    status: Status,
    parts: BuiltAgent,
    config: HyPerNavConfig,
) -> KeyboardInterrupt | MemoryStartError | ModelSetupError | OutputError | None:
    """Run the search to its end; returns the error that stopped it, if any."""
    is_paced = False
    try:
        views.await_watchers(status)
        status.update("the first step …")
        with interruptions_of_kernels():
            for step in search:
                with interruptions_put_off():  # an incomplete frame would break the video
                    views.add(step.trace, step.grid, step.observation)
                asked = parts.ledger.total
                if asked.calls and not is_paced:
                    is_paced = True
                    kinds = kinds_asked(parts.chosen)
                    said = pace_words(asked.seconds / asked.calls, config, kinds)
                    console.print(said, markup=False, soft_wrap=True)
                status.update(escape(live_line(step)))
                views.keep_pace()
    except (KeyboardInterrupt, MemoryStartError, ModelSetupError, OutputError) as stop:
        return stop
    return None


def _finish(views: Views, result: dict[str, Any], console: Console) -> OutputError | None:
    """Write all files; prints and returns the error if some could not be written."""
    try:
        views.finish(result)
    except OutputError as error:
        console.print(f"[red]{escape(str(error))}[/]", soft_wrap=True)
        return error
    return None


def _found_start(search: EpisodeRun) -> dict[str, Any]:
    return {} if search.found_start is None else {"found_start": search.found_start.as_dict()}


def _memory_entry(
    options: FindOptions, search: EpisodeRun, earlier_searches: int
) -> dict[str, Any]:
    """The memory that the search began with; empty if it began with none."""
    is_lost = search.found_start is not None and bool(search.found_start.doubt)
    if options.memory is None or is_lost:
        return {}
    folder = options.memory.resolve().name
    return {"memory": {"folder": folder, "earlier_searches": earlier_searches}}


def _new_folder(goal: Goal) -> Path:
    name = re.sub(r"[\W_]+", "-", goal.text.lower()).strip("-")[:40] or "goal"
    return Path("runs") / f"{datetime.now():%Y%m%d-%H%M%S}-{name}"
