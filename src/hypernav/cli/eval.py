"""The command `hypernav eval`: run a whole benchmark so that no interruption loses results."""

import re
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.live import Live
from rich.markup import escape

from hypernav.build.choosing import choose_components
from hypernav.build.exam_file import read_exam
from hypernav.build.presets import HyPerNavConfig
from hypernav.cli.guards.crashes import crash_report
from hypernav.cli.guards.outputs import check_folder
from hypernav.cli.guards.statuses import ExitStatus
from hypernav.cli.options.agent import check_steps_and_seed
from hypernav.cli.options.eval import Options
from hypernav.cli.screen.eval_table import outcome_lines, progress_line, progress_table
from hypernav.cli.screen.terminal import Terminal
from hypernav.cli.screen.warnings_shown import warnings_on
from hypernav.core.config import MOST_THREADS, check_option
from hypernav.core.episodes.episode import MAX_STEPS, Episode
from hypernav.core.episodes.metrics import SUCCESS_DISTANCE_M
from hypernav.core.errors import ConfigError, GoalError
from hypernav.datasets.benchmarks import benchmark_of
from hypernav.evaluation.run_cost import cost_by_episodes, cost_by_exam, cost_lines, kinds_asked
from hypernav.evaluation.run_plan import RunPlan, Selection
from hypernav.evaluation.run_session import RunSession, available_cores
from hypernav.evaluation.runner import RunProgress, check_scored, crash_of, run_episodes
from hypernav.evaluation.store.run_store import RunStore
from hypernav.evaluation.store.scene_files import keep_scenes
from hypernav.evaluation.workers.process_pool import ProcessPool
from hypernav.evaluation.workers.ray_pool import RayPool
from hypernav.evaluation.workers.worker import Job
from hypernav.evaluation.workers.worker_pool import WorkerPool
from hypernav.models.chat.vlm_spec import parse_vlm_spec
from hypernav.worlds.habitat.simulator import require_habitat

_LINE_EVERY_S = 60.0
_PLANNED_BY = 10
"""Number of episodes by which a run without an exam is planned."""


def run(options: Options) -> int:
    """Run the command.

    Returns:
        The status of success: every episode is done.

    Raises:
        HyPerNavError: The run cannot be started, stopped before its end, or has no result.
        ReportedCrashError: The program failed in some of the episodes.
    """
    check(options)
    folder = options.out or Path("runs") / folder_name(f"{options.dataset}-{options.who.name}")
    check_folder(folder)
    console = Terminal(quiet=options.quiet)
    with crash_report(folder):
        if options.plan and options.who.exam is not None:
            _say_cost_by_exam(options, options.who.exam, console)
            return ExitStatus.SUCCESS
        progress = evaluate(options, folder, console)
        for line in outcome_lines(progress, folder):
            console.print(line, soft_wrap=True)
        if options.plan and progress.records:
            _say_cost_by_episodes(options, progress, console)
        if progress.crashes:
            raise crash_of(progress)
        check_scored(progress)
    return ExitStatus.SUCCESS


def evaluate(
    options: Options, folder: Path, console: Terminal, *, heading: str = ""
) -> RunProgress:
    """Load the episodes, and run those that aren't done.

    Args:
        options: All options but the folder.
        folder: Folder of the run.
        console: Terminal that shows the progress.
        heading: Line to print when the run begins; empty for none.

    Returns:
        The state of the run at its end.

    Raises:
        HyPerNavError: The run cannot be started, or stopped before its end.
    """
    with warnings_on(console):
        plan, episodes = planned(options, console)
    with RunStore(folder, plan.configuration(episodes)) as store:
        if heading:
            console.print(heading)
        if again := store.withdraw(lambda record: not record.counts):
            console.print(f"{again} episodes that don't count are run again")
        with console.status("looking at the files of the scenes …") as status:
            keep_scenes(
                store,
                episodes,
                lambda done, total: status.update(f"reading the scenes, {done} of {total} …"),
            )
        if store.records:
            console.print(f"{len(store.records)} of {len(episodes)} episodes are done already")
        pool = _pool(options, folder, plan.config)
        session = RunSession(store, worker_count(options))
        now = episodes[:_PLANNED_BY] if options.plan else episodes
        try:
            with session:
                progress = _watch(console, now, store, pool, session)
                progress.total = len(episodes)
                return progress
        except KeyboardInterrupt:
            console.print(
                f"interrupted; {len(store.records)} of {len(episodes)} episodes are safe in "
                f"{folder}. Run the same command again to go on",
                soft_wrap=True,
            )
            raise


def _say_cost_by_exam(options: Options, exam: Path, console: Console) -> None:
    """Say what the run costs, and run nothing."""
    who = options.who
    if who.agent != "hypernav":
        raise ConfigError(
            f"--plan: an exam predicts searches of --agent hypernav, not of {who.agent}; without "
            "--exam the first ten episodes tell"
        )
    plan, episodes = planned(options, console)
    kinds = kinds_asked(choose_components(who.specs, presence=plan.config.presence.enabled))
    cost = cost_by_exam(read_exam(exam), who.preset, plan.config, kinds)
    for line in cost_lines(cost, len(episodes), worker_count(options), plan.config):
        console.print(line, soft_wrap=True)


def _say_cost_by_episodes(options: Options, progress: RunProgress, console: Console) -> None:
    config = config_of(options)
    kinds = kinds_asked(choose_components(options.who.specs, presence=config.presence.enabled))
    cost = cost_by_episodes(progress.records, config, kinds)
    console.print(f"by these {len(progress.records)} episodes:")
    for line in cost_lines(cost, progress.total, worker_count(options), config):
        console.print(line, soft_wrap=True)


def worker_count(options: Options) -> int:
    """Number of workers; by default one if each would load a model, else one per core."""
    vlm = options.who.vlm
    loads_model = vlm is not None and parse_vlm_spec(vlm).kind == "local"
    return options.workers or (1 if loads_model else available_cores())


def check(options: Options) -> None:
    """Refuse options that are impossible in any run.

    Raises:
        ConfigError: An option is impossible.
        MissingExtraError: The world needs a program that is not installed.
    """
    check_steps_and_seed(options.max_steps, options.seed)
    if options.success_distance is not None:
        check_option(
            "--success-distance", options.success_distance, (0.001, 100.0), "must be more than 0"
        )
    if options.workers is not None:
        check_option("--workers", options.workers, (1, MOST_THREADS), "at least one is needed")
    if options.world == "habitat":
        require_habitat()
    benchmark = benchmark_of(options.dataset, options.benchmark)
    if benchmark is not None and benchmark.segmenter and options.who.segmenter is None:
        raise ConfigError(
            f"{benchmark.name} is run with {benchmark.segmenter}: name its files, --segmenter "
            "onnx-sam:mobile_sam_encoder.onnx,mobile_sam_decoder.onnx, or a substitute, such as "
            "--segmenter depth-cut, which results and reports then name"
        )
    if options.who.record is not None:
        raise ConfigError(
            "--record is for single searches: use it with hypernav find; an evaluation keeps "
            "questions and answers in the traces of --save videos"
        )


def planned(options: Options, console: Console) -> tuple[RunPlan, list[Episode]]:
    """The run and its episodes, after checking that the agent can be built and can see the goals.

    Raises:
        HyPerNavError: The run cannot be started.
    """
    config = config_of(options)
    with console.status("loading the episodes …") as status:
        plan = plan_of(options, config)
        episodes = plan.episodes(
            lambda done, total: status.update(f"loading the episodes, {done} of {total} …")
        )
        benchmark = benchmark_of(options.dataset, options.benchmark)
        for caveat in () if benchmark is None else benchmark.caveats:
            console.print(f"[yellow]{escape(caveat)}[/]", soft_wrap=True)
        return replace(plan, who=_who(options, config, episodes, console)), episodes


def config_of(options: Options) -> HyPerNavConfig:
    """The whole configuration, with the robot of the benchmark that the run follows."""
    benchmark = benchmark_of(options.dataset, options.benchmark)
    if benchmark is None:
        return options.who.resolve()
    config = options.who.resolve(benchmark.embodiment)
    # The plan and all reports name the segmenter that replaces the benchmark's.
    local = config.local.model_copy(
        update={"published_segmenter": config.local.published_segmenter or benchmark.segmenter}
    )
    return config.model_copy(update={"local": local})


def plan_of(options: Options, config: HyPerNavConfig) -> RunPlan:
    """The run that the options ask for, without the description of its agent."""
    benchmark = benchmark_of(options.dataset, options.benchmark)
    steps, distance_m = (
        (MAX_STEPS, SUCCESS_DISTANCE_M)
        if benchmark is None
        else (benchmark.max_steps, benchmark.success_distance_m)
    )
    return RunPlan(
        dataset=options.dataset,
        selection=Selection(options.episodes, options.scenes, options.goals),
        config=config,
        max_steps=options.max_steps or options.who.step_limit(steps),
        success_distance_m=(
            distance_m if options.success_distance is None else options.success_distance
        ),
        seed=options.seed,
        scenes_dir=options.scenes_dir,
        world=options.world,
        benchmark=options.benchmark,
    )


def _who(
    options: Options, config: HyPerNavConfig, episodes: Sequence[Episode], console: Console
) -> dict[str, Any]:
    """Description of the agent, after checking that it can be built and can see the goals."""
    parts = options.who.build(config)
    for warning in parts.warnings:
        console.print(f"[yellow]{escape(warning)}[/]", soft_wrap=True)
    goals = dict.fromkeys(episode.goal for episode in episodes)
    visible, first_error = [], None
    for goal in goals:
        try:
            parts.check_goal(goal)
            visible.append(goal.text)
        except GoalError as error:
            first_error = first_error or error
    parts.close()
    if first_error is not None:
        raise GoalError(f"{first_error}; choose others: --goals '{','.join(visible)}'")
    return options.who.describe(parts)


def _pool(options: Options, folder: Path, config: HyPerNavConfig) -> WorkerPool:
    job = Job(
        folder=folder,
        config=config,
        specs=options.who.specs,
        seed=options.seed,
        save=options.save,
        world=options.world,
    )
    return ProcessPool(job) if options.ray is None else RayPool(job, options.ray)


def _watch(
    console: Console,
    episodes: Sequence[Episode],
    store: RunStore,
    pool: WorkerPool,
    session: RunSession,
) -> RunProgress:
    """Run the episodes under a live table, or, without a terminal, with a line every minute."""
    live = Live(console=console, refresh_per_second=2, transient=True)
    said = 0.0

    def watch(progress: RunProgress) -> None:
        nonlocal said
        session.progress = progress
        if console.is_terminal:
            live.update(progress_table(progress, session.seconds))
        elif session.seconds - said >= _LINE_EVERY_S:
            said = session.seconds
            console.print(progress_line(progress, session.seconds), soft_wrap=True)

    with live if console.is_terminal else nullcontext():
        return run_episodes(episodes, store, pool, workers=session.workers, watch=watch)


def folder_name(text: str) -> str:
    """A text as the name of a folder."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[:80]
