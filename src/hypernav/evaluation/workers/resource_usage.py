"""Memory and processor time of workers."""

import sys


def peak_memory_mb() -> float:
    """Peak resident memory of this process, megabytes; 0 if the system doesn't provide it."""
    if sys.platform == "win32":
        return 0.0
    import resource

    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    unit = 1024 if sys.platform == "linux" else 1
    return round(peak * unit / 1e6, 1)


def cpu_seconds_of_ended_workers() -> float:
    """Processor time of all ended child processes; 0 if the system doesn't provide it."""
    if sys.platform == "win32":
        return 0.0
    import resource

    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return round(used.ru_utime + used.ru_stime, 1)
