"""Evaluating an agent of your own from a program; `hypernav eval` does the same for ours."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from hypernav.core.protocols import Agent
from hypernav.evaluation.run_plan import RunPlan
from hypernav.evaluation.runner import RunNews, run_episodes
from hypernav.evaluation.save_choice import SaveChoice
from hypernav.evaluation.store.run_store import RunStore
from hypernav.evaluation.workers.process_pool import ProcessPool
from hypernav.evaluation.workers.worker import Job


def evaluate(
    plan: RunPlan,
    folder: Path,
    make_agent: Callable[[], Agent],
    *,
    workers: int = 1,
    save: SaveChoice = "none",
    watch: Callable[[RunNews], None] | None = None,
) -> RunNews:
    """Run an agent of your own over a data set; the same call goes on where it was interrupted.

    Workers are processes, so a program that calls this needs ``if __name__ == "__main__":``, and
    the factory must be a function or class that they can import.

    Args:
        plan: Data set, robot and protocol. What `RunPlan.who` leaves open is filled in.
        folder: Of the run; `hypernav.evaluation.report.write_report` reads it.
        make_agent: Builds the agent, once in every worker.
        workers: How many processes.
        save: Which episodes keep page and video.
        watch: Is told whenever something has happened.

    Raises:
        RunFolderError: The folder can't be used.
        RunHaltedError: The run stopped before its end.
    """
    name = getattr(make_agent, "__name__", type(make_agent).__name__)
    own = {"agent": name, "preset": "its own", "detector": "its own", "reasoner": "its own"}
    plan = replace(plan, who=own | plan.who)
    episodes = plan.episodes()
    job = Job(
        folder=folder,
        config=plan.config,
        seed=plan.seed,
        save=save,
        make_agent=make_agent,
    )
    with RunStore(folder, plan.configuration(episodes)) as store:
        store.take_out(lambda record: not record.counts)
        return run_episodes(episodes, store, ProcessPool(job), workers=workers, watch=watch)
