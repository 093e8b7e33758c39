"""Evaluates an agent of your own from a Python program, like the command `hypernav eval`."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from hypernav.app.show.captions import ITS_OWN
from hypernav.core.components.protocols import Agent
from hypernav.core.config import MOST_SEED, MOST_STEPS, MOST_THREADS, check_option
from hypernav.core.errors import ContractError
from hypernav.lab.evaluation.choices import SaveChoice
from hypernav.lab.evaluation.run_plan import RunPlan
from hypernav.lab.evaluation.runner import RunProgress, begin_again, run_episodes
from hypernav.lab.evaluation.store.run_store import RunStore
from hypernav.lab.evaluation.store.scene_files import keep_scenes
from hypernav.lab.evaluation.workers.job import Job
from hypernav.lab.evaluation.workers.process_pool import ProcessPool
from hypernav.lab.evaluation.workers.searcher import factory_name


def evaluate(
    plan: RunPlan,
    folder: str | Path,
    make_agent: Callable[[], Agent],
    *,
    workers: int = 1,
    save: SaveChoice = "none",
    watch: Callable[[RunProgress], None] | None = None,
) -> RunProgress:
    """Run an agent of your own over a data set; the same call resumes an interrupted run.

    Workers are processes, so a program that calls this needs ``if __name__ == "__main__":``, and
    the factory must be a function or class that they can import.

    Args:
        plan: Data set, robot and protocol. Missing entries of `RunPlan.who` are filled in.
        folder: Folder of the run; `hypernav.load_runs` reads it for `hypernav.write_report`.
        make_agent: Factory of the agent, called once in every worker.
        workers: Number of processes.
        save: Choice of episodes that keep page and video.
        watch: Function that is called with the state of the run whenever it has changed.

    Returns:
        The state of the run at its end, with the records of all episodes.

    Raises:
        ComponentError: The agent fails repeatedly.
        ConfigError: A number is impossible.
        ContractError: The factory is none.
        RunFolderError: The folder can't be used.
        RunHaltedError: The run stopped before its end.
        EpisodeError: There is no such data set, or the selection is empty.
        SceneError: A scene cannot be used.
    """
    if not callable(make_agent):
        raise ContractError(f"make_agent is {make_agent!r:.60}, expected a class or a function")
    check_option("workers", workers, (1, MOST_THREADS), "processes")
    check_option("max_steps", plan.max_steps, (1, MOST_STEPS), "steps of a search")
    check_option("seed", plan.seed, (0, MOST_SEED), "a whole number")
    own = dict.fromkeys(("preset", "detector", "reasoner"), ITS_OWN)
    plan = replace(plan, who={"agent": factory_name(make_agent), **own} | plan.who)
    folder = Path(folder)
    plan, episodes = plan.chosen()
    job = Job(
        folder=folder,
        config=plan.config,
        seed=plan.seed,
        save=save,
        make_agent=make_agent,
        world=plan.world,
        fresh_memory=plan.fresh_memory,
    )
    with RunStore(folder, plan.configuration(episodes)) as store:
        begin_again(episodes, store)
        keep_scenes(store, episodes)
        return run_episodes(episodes, store, ProcessPool(job), workers=workers, watch=watch)
