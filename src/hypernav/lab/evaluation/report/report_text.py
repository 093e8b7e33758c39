"""Sentences of a report: title, warnings, verdicts, protocol and sessions."""

from collections.abc import Sequence

from hypernav.app.show import captions
from hypernav.core.naming.words import number_of
from hypernav.lab.datasets.goat import goal_type_words
from hypernav.lab.episodes.goal_sight import MIN_VISIBLE_SHARE
from hypernav.lab.evaluation import statistics
from hypernav.lab.evaluation.failures import MISPLACED_M, Failure
from hypernav.lab.evaluation.report.run_data import RunData
from hypernav.lab.evaluation.report.tables import Pair
from hypernav.lab.evaluation.statistics import (
    FEWEST_WITH_INTERVAL,
    Summary,
    interval,
    percent,
)
from hypernav.simulator.houses.building import NOUNS
from hypernav.simulator.worlds.config import NoiseConfig

SIGNIFICANT = 0.05

RULES_IN_WORDS: dict[Failure, str] = {
    Failure.MODEL_UNAVAILABLE: "A model refused a question or gave no answer in time. Not counted.",
    Failure.SIMULATOR_ERROR: "The world, or the process that ran it, failed. Not counted.",
    Failure.UNREACHABLE: "The scene holds the goal, but no path leads there from the start.",
    Failure.LANGUAGE: "What the robot took for the goal only has a similar name.",
    Failure.FALSE_DETECTION: "What it took for the goal is neither the goal nor similar by name.",
    Failure.WRONG_MAP: (
        f"It took the right object for the goal, but the area lay more than {MISPLACED_M:g} m off, "
        "or its map blocked a way that is really open."
    ),
    Failure.TARGET_SURROUNDED: (
        "It took the right object for the goal, but nobody could stand within the stop distance of "
        "the goal area."
    ),
    Failure.STOPPED_TOO_FAR: (
        "It took the right object for the goal and stopped, but beyond the success distance."
    ),
    Failure.MISSING_DATA: (
        "It took the right object for the goal and its map has a path there, which leads where "
        "nobody can stand; its images lacked what is there, as at a hole in a scan."
    ),
    Failure.SEEN_TOO_LATE: (
        "It took the right object for the goal when the shortest path was longer than its last "
        "steps could be."
    ),
    Failure.PATH_PLANNING: (
        "It took the right object for the goal and its map has a path there, but it didn't arrive."
    ),
    Failure.SEEN_BUT_MISSED: (
        f"The goal filled at least {100 * MIN_VISIBLE_SHARE:g} % of some image, but the robot "
        "ended without a goal area."
    ),
    Failure.NEVER_SEEN: "The goal was never in the image.",
}
"""The rules of `hypernav.lab.evaluation.failures`, for people."""


def title(runs: Sequence[RunData]) -> str:
    """Title of a report: data sets and runs."""
    names = [run.name for run in runs]
    listed = names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
    datasets = dict.fromkeys(run.dataset for run in runs)
    return f"{', '.join(datasets)}: {listed}"


def lead(runs: Sequence[RunData], summaries: Sequence[Summary]) -> str:
    """Main result, in a sentence or two."""
    parts = []
    for run, summary in zip(runs, summaries, strict=True):
        parts.append(
            f"{run.name} found its goal in {percent(summary.success)} of "
            f"{number_of(summary.success.count, 'episode')}"
            f"{interval(summary.success, 100.0, ' (95 % interval {} to {} %)')} with an SPL of "
            f"{summary.spl.mean:.3f}{interval(summary.spl)}"
        )
    return "; ".join(parts) + "."


_STAND_IN = "stand-in"
"""Text in the description of every reasoner that replaces a model."""


def warnings(runs: Sequence[RunData]) -> list[str]:
    """Caveats that a reader must know before believing a number."""
    found = []
    told = [run.name for run in runs if run.is_told_truth]
    if told:
        found.append(
            f"{' and '.join(told)}: the simulator told the robot what it sees (ground-truth "
            "detection). This measures exploration, mapping, planning and stopping, and says "
            "nothing about recognition."
        )
    found += [
        f"{run.name} reasons by {run.who['reasoner']}, in place of a model: this measures what "
        "the method makes of its answers, not how good a model's would be."
        for run in runs
        if _STAND_IN in run.who["reasoner"]
    ]
    found += [
        f"{run.name} has the camera, step and stop of its publication (native mode): its numbers "
        "cannot be compared with runs of common mode."
        for run in runs
        if run.is_native
    ]
    found += [
        f"{run.name} makes the mistakes of its method's released code: its numbers are those of "
        "that code, not of the method."
        for run in runs
        if run.errs_as_released
    ]
    found += [
        f"{run.name} follows {run.benchmark.name}. {' '.join(run.benchmark.caveats)}"
        for run in runs
        if run.benchmark is not None and run.benchmark.caveats
    ]
    for run in runs:
        if len(run.records) < run.wanted:
            found.append(
                f"{run.name} is not finished: {len(run.records):,} of {run.wanted:,} episodes."
            )
        apart = len(run.records) - len(run.counted)
        if apart:
            found.append(
                f"{run.name}: {apart} episodes ended by a model or simulator outage are counted "
                "apart and excluded from all rates. Running the command again repeats them."
            )
        is_one = len({record.scene_id for record in run.counted}) == 1
        if is_one and len(run.counted) >= FEWEST_WITH_INTERVAL:
            found.append(
                f"{run.name} has a single scene: its intervals say nothing about other scenes."
            )
    found += [
        f"{run.name} leaves out {goal_type_words(out)} of GOAT-Bench, so its numbers are of "
        "another selection than published ones."
        for run in runs
        if (out := run.configuration.get("goal_types", {}).get("left_out"))
    ]
    found += [
        f"{run.name}: its agent keeps no memory, so every goal of a life is a search of its own."
        for run in runs
        if not run.who.get("keeps_memory", True)
    ]
    fingerprints = {run.configuration["episodes"]["fingerprint"] for run in runs}
    if len(fingerprints) > 1:
        found.append("The runs have different episodes; only --compare pairs them.")
    return found


def verdict(pair: Pair) -> str:
    """Result of a comparison, in a sentence."""
    parts = []
    for name, compared, unit in (("SR", pair.success, 100.0), ("SPL", pair.spl, 1.0)):
        gap = compared.difference
        size = f"{unit * abs(gap.mean):.1f} points" if unit > 1 else f"{abs(gap.mean):.3f}"
        if compared.p_value < SIGNIFICANT:
            side = "higher" if gap.mean > 0 else "lower"
            parts.append(f"its {name} is {size} {side} (p {p_value(compared.p_value)})")
        else:
            parts.append(f"no difference in {name} is shown (p {p_value(compared.p_value)})")
    least = pair.spl.least_p_value
    few = f" With so few scenes p is never below {least:.3f}: take episodes of six scenes or more."
    return (
        f"{pair.second} against {pair.first} on the {pair.count:,} episodes that count in both: "
        + ", and ".join(parts)
        + "."
        + (few if least >= SIGNIFICANT else "")
    )


def protocol_lines(run: RunData) -> list[tuple[str, str]]:
    """The protocol in full, as name and value."""
    told, config = run.configuration["protocol"], run.configuration["config"]
    world, embodiment = config["world"], config["embodiment"]
    camera, body, motion = embodiment["camera"], embodiment["body"], embodiment["motion"]
    episodes, who = run.configuration["episodes"], run.who
    chosen = {k: v for k, v in run.configuration["selection"].items() if v is not None}
    part = ", ".join(f"{name} {value}" for name, value in chosen.items())
    noise = {} if NoiseConfig.model_validate(world["noise"]).is_off else world["noise"]
    return [
        ("Data set", run.dataset + (f" ({part})" if part else "")),
        (
            "Episodes",
            f"{episodes['count']:,} in {number_of(episodes['scenes'], 'scene')}, fingerprint "
            f"{episodes['fingerprint']}",
        ),
        (
            "Success",
            f"{told['stop_rule']}; geodesic distance to the nearest view point under "
            f"{told['success_distance_m']:g} m. View points: standable positions within 1.0 m of "
            "the object's box from which it is visible",
        ),
        ("Steps", f"at most {told['max_steps']}, STOP included"),
        *_life_lines(run),
        ("SPL", "success x shortest path / max(shortest path, path walked), lengths in metres"),
        ("SoftSPL", "the same with 1 - distance at the end / distance at the start for success"),
        (
            "Actions",
            f"forward {motion['forward_m']:g} m, turn {motion['turn_angle_deg']:g}°, sliding "
            f"{'on' if world['sliding'] else 'off'}",
        ),
        (
            "Camera",
            f"{camera['width']}×{camera['height']}, {camera['hfov_deg']:g}° wide, "
            f"{camera['height_m']:g} m high, depth {camera['min_depth_m']:g} to "
            f"{camera['max_depth_m']:g} m",
        ),
        (
            "Robot",
            f"radius {body['radius_m']:g} m, height {body['height_m']:g} m, steps over "
            f"{body['max_step_m']:g} m",
        ),
        ("Noise", ", ".join(f"{name} {value}" for name, value in noise.items() if value) or "none"),
        ("Agent", f"{who['agent']}, preset {who['preset']}"),
        ("Sees with", captions.component_caption(str(who["detector"]))),
        ("Segments with", str(who.get("segmenter", "–"))),
        ("Model", str(who.get("model", "–"))),
        ("Decides with", captions.component_caption(str(who["reasoner"]))),
        ("Seed", str(told["seed"])),
        ("Software", f"hypernav {run.configuration['hypernav']}"),
        (
            "Intervals",
            f"95 %, percentile bootstrap over {drawn(run)} (10,000 draws); with a rate of 0 or "
            "100 % in each of them the interval has no width, which overstates what is known",
        ),
    ]


def _life_lines(run: RunData) -> list[tuple[str, str]]:
    """How the lives of a run were lived; empty if it has none."""
    if (lives := run.configuration.get("lives")) is None:
        return []
    count, limit = lives["count"], lives["max_steps"]
    return [
        (
            "Lives",
            f"{number_of(count, 'life', 'lives')} of several goals each; memory: "
            f"{lives['memory']}; a goal is searched from where the robot stands, and its shortest "
            "path counts from there" + (f"; at most {limit:,} steps a life" if limit else ""),
        )
    ]


def other_protocol_lines(run: RunData, first: RunData) -> list[tuple[str, str]]:
    """Where the protocol of a run differs from that of the first run of a report."""
    known = dict(protocol_lines(first))
    return [(name, value) for name, value in protocol_lines(run) if known.get(name) != value]


def setting(run: RunData) -> str:
    """Protocol in a line, for comparison with published ones."""
    kind, count = run.dataset.partition("-")[0], run.configuration["episodes"]["scenes"]
    scenes = f"generated {kind}" if kind in NOUNS else number_of(count, "scene")
    sees = "ground-truth detection" if run.is_told_truth else f"sees with {run.who['detector']}"
    return f"{scenes}; {sees}; at most {run.configuration['protocol']['max_steps']} steps"


def reached(run: RunData) -> str:
    """What counts as reached, in words."""
    distance_m = run.configuration["protocol"]["success_distance_m"]
    return f"STOP within {distance_m:g} m of a view point"


def step(run: RunData) -> str:
    """Length of a step, in words."""
    return f"{run.configuration['config']['embodiment']['motion']['forward_m']:g} m"


def step_seconds(run: RunData) -> str:
    """Mean time of a step, the simulator's included, seconds, in words."""
    steps = sum(record.steps for record in run.records)
    seconds = sum(record.seconds.get("total", 0.0) for record in run.records)
    return f"{seconds / steps:.2f}" if steps and seconds else "–"


def session_lines(run: RunData) -> list[str]:
    """Every start of the program in a line."""
    lines = []
    for session in run.sessions:
        hours = session.seconds / 3600
        rate = session.episodes / hours if hours else 0.0
        text = (
            f"{session.began}: {number_of(session.episodes, 'episode')} in "
            f"{captions.duration(session.seconds)} with {number_of(session.workers, 'worker')} on "
            f"{number_of(session.cores, 'core')} "
            f"({rate:,.0f} an hour), {session.ended}"
        )
        if session.peak_memory_mb:
            peak = max(session.peak_memory_mb.values())
            text += f"; a worker used at most {peak:,.0f} MB"
        if session.workers_lost:
            text += f"; {session.workers_lost} workers were lost and replaced"
        lines.append(text)
    return lines


def drawn(run: RunData) -> str:
    """What bootstrap and flips draw: the scenes of a run, or the episodes of its only one."""
    return statistics.drawn(record.scene_id for record in run.counted)


def drawn_in(runs: Sequence[RunData]) -> str:
    """What they draw in each of some runs, which are named where that differs."""
    kinds = {run.name: drawn(run) for run in runs}
    if len(set(kinds.values())) == 1:
        return drawn(runs[0])
    return ", ".join(f"{kind} ({name})" for name, kind in kinds.items())


def p_value(value: float) -> str:
    """A p-value in the notation of papers."""
    return "< 0.001" if value < 0.001 else f"= {value:.3f}"
