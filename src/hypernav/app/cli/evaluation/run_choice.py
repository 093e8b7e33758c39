"""From the options of `hypernav eval` to a run: its episodes and its agent, checked."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from rich.console import Console
from rich.markup import escape

from hypernav.app.build.presets import HyPerNavConfig
from hypernav.app.cli.options.agent import check_steps_and_seed
from hypernav.app.cli.options.commands import EvalOptions
from hypernav.core.components.abilities import remembers
from hypernav.core.config import MOST_THREADS, check_option
from hypernav.core.episode import MAX_STEPS, SUCCESS_DISTANCE_M, Episode
from hypernav.core.errors import ConfigError, GoalError
from hypernav.lab.datasets.benchmarks import benchmark_of
from hypernav.lab.datasets.goat import goal_type_words, goal_types_in
from hypernav.lab.evaluation.run_plan import RunPlan, Selection
from hypernav.lab.evaluation.runner import available_cores
from hypernav.search.models.chat.vlm_spec import parse_vlm_spec


def worker_count(options: EvalOptions) -> int:
    """Number of workers; by default one if each would load a model, else one per core."""
    vlm = options.who.vlm
    loads_model = vlm is not None and parse_vlm_spec(vlm).kind == "local"
    return options.workers or (1 if loads_model else available_cores())


def check(options: EvalOptions) -> None:
    """Refuse options that are impossible in any run.

    Raises:
        ConfigError: An option is impossible.
        MissingExtraError: The world needs a program that is not installed.
    """
    check_steps_and_seed(options.max_steps, options.seed)
    if options.success_distance is not None:
        check_option("--success-distance", options.success_distance, (0.001, 100.0), "metres")
    if options.workers is not None:
        check_option("--workers", options.workers, (1, MOST_THREADS), "processes")
    if options.world == "habitat":
        from hypernav.simulator.worlds.habitat import require_habitat

        require_habitat()
    _check_published_networks(options)


def _check_published_networks(options: EvalOptions) -> None:
    """Refuse a benchmark with published networks where the run doesn't name what it uses.

    Raises:
        ConfigError: Segmenter or model are left open.
    """
    benchmark, who = benchmark_of(options.dataset, options.benchmark), options.who
    if benchmark is None:
        return
    if benchmark.model and who.vlm is None and not (who.detector and who.reasoner):
        raise ConfigError(
            f"{benchmark.name} is run with {benchmark.model}: name the model, --vlm "
            "openai:http://localhost:8000/v1, or what replaces it, such as --detector ground-truth "
            "--reasoner geometric, which results and reports then name"
        )
    if benchmark.segmenter and who.segmenter is None:
        raise ConfigError(
            f"{benchmark.name} is run with {benchmark.segmenter}: name its files, --segmenter "
            "onnx-sam:mobile_sam_encoder.onnx,mobile_sam_decoder.onnx, or a substitute, such as "
            "--segmenter depth-cut, which results and reports then name"
        )


def planned(options: EvalOptions, console: Console) -> tuple[RunPlan, list[Episode]]:
    """The run and its episodes, after checking that the agent can be built and can see the goals.

    Raises:
        HyPerNavError: The run cannot be started.
    """
    config = config_of(options)
    with console.status("loading the episodes …") as status:
        plan = plan_of(options, config)
        plan, episodes = plan.chosen(
            lambda done, total: status.update(f"loading the episodes, {done} of {total} …")
        )
        benchmark = benchmark_of(options.dataset, options.benchmark)
        for caveat in () if benchmark is None else benchmark.caveats:
            console.print(f"[yellow]{escape(caveat)}[/]", soft_wrap=True)
        plan = replace(plan, who=_who(options, config, episodes, console))
    _say_lives(plan, episodes, console)
    return plan, episodes


def _say_lives(plan: RunPlan, episodes: Sequence[Episode], console: Console) -> None:
    """Say how many lives there are, and what becomes of their memory.

    Raises:
        ConfigError: A fresh memory was asked for, and there are no lives.
    """
    if plan.goal_types:
        out = f"; left out: {goal_type_words(plan.left_out)}" if plan.left_out else ""
        console.print(f"goal types: {', '.join(plan.goal_types)}{out}", soft_wrap=True)
    if lives := plan.lives(episodes):
        count, memory = lives["count"], lives["memory"]
        noun = "life" if count == 1 else "lives"
        console.print(f"{count} {noun} with {len(episodes)} goals, memory: {memory}")
    elif plan.fresh_memory:
        raise ConfigError(
            f"--fresh-memory: the episodes of {plan.dataset} belong to no lives, so each begins "
            "without memory anyway; leave it out"
        )


def config_of(options: EvalOptions) -> HyPerNavConfig:
    """The whole configuration, with the robot of the benchmark that the run follows."""
    benchmark = benchmark_of(options.dataset, options.benchmark)
    if benchmark is None:
        return options.who.resolve().for_steps(_steps_of(options))
    config = options.who.resolve(benchmark.embodiment).for_steps(_steps_of(options))
    # The plan and all reports name the benchmark's segmenter and model beside those in use.
    local = config.local.model_copy(
        update={"published_segmenter": config.local.published_segmenter or benchmark.segmenter}
    )
    chat = config.chat.model_copy(
        update={"published_model": config.chat.published_model or benchmark.model}
    )
    return config.model_copy(update={"local": local, "chat": chat})


def plan_of(options: EvalOptions, config: HyPerNavConfig) -> RunPlan:
    """The run that the options ask for, without the description of its agent."""
    benchmark = benchmark_of(options.dataset, options.benchmark)
    distance_m = SUCCESS_DISTANCE_M if benchmark is None else benchmark.success_distance_m
    return RunPlan(
        dataset=options.dataset,
        selection=Selection(options.episodes, options.scenes, options.goals),
        config=config,
        max_steps=_steps_of(options),
        success_distance_m=(
            distance_m if options.success_distance is None else options.success_distance
        ),
        seed=options.seed,
        scenes_dir=options.scenes_dir,
        world=options.world,
        benchmark=options.benchmark,
        max_life_steps=None if benchmark is None else benchmark.max_life_steps,
        fresh_memory=options.fresh_memory,
        goal_types=_goal_types(options),
    )


def _steps_of(options: EvalOptions) -> int:
    """Number of steps after which a search ends."""
    benchmark = benchmark_of(options.dataset, options.benchmark)
    own = MAX_STEPS if benchmark is None else benchmark.max_steps
    return options.max_steps or options.who.step_limit(own)


def _goal_types(options: EvalOptions) -> tuple[str, ...]:
    """The goal types that were asked for; empty for the default."""
    if options.goal_types is None:
        return ()
    own = benchmark_of(options.dataset)
    if own is None or not own.goal_types:
        raise ConfigError(f"--goal-types: the goals of {options.dataset} are of one type")
    return goal_types_in(options.goal_types)


def _who(
    options: EvalOptions, config: HyPerNavConfig, episodes: Sequence[Episode], console: Console
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
    keeps_memory = remembers(parts.agent)
    parts.close()
    if first_error is not None:
        raise GoalError(f"{first_error}; choose others: --goals '{','.join(visible)}'")
    forgets = (
        {}
        if keeps_memory or not any(episode.life for episode in episodes)
        else {"keeps_memory": False}
    )
    return options.who.describe(parts) | forgets
