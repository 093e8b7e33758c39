"""Who may have ended a worker's process from inside."""

from hypernav.build.choosing import choose_components
from hypernav.evaluation.workers.searcher import factory_name
from hypernav.evaluation.workers.worker import Job


def own_components(job: Job) -> list[str]:
    """Names of the components of a user's own in a job; none if all are of this package."""
    if job.make_agent is not None:
        return [factory_name(job.make_agent)]
    chosen = choose_components(job.specs, presence=job.config.presence.enabled).by_kind
    return [f"--{kind} {one.spec}" for kind, one in chosen.items() if one.entry.is_foreign]
