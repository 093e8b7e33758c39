"""Tables beside a report: every episode as CSV, the main tables as LaTeX, lives as JSON."""

import csv
import json
import math
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from hypernav.evaluation.protocol import PROTOCOLS, EvaluationProtocol, Reference, StopRule
from hypernav.evaluation.report import lives, tables
from hypernav.evaluation.report.report_text import drawn_in
from hypernav.evaluation.report.run_data import RunData
from hypernav.evaluation.statistics import Estimate

_TEX_SPECIAL = str.maketrans(
    {
        "\\": r"\textbackslash{}",
        "&": r"\&",
        "%": r"\%",
        "$": r"\$",
        "#": r"\#",
        "_": r"\_",
        "{": r"\{",
        "}": r"\}",
        "~": r"\textasciitilde{}",
        "^": r"\textasciicircum{}",
    }
)


def write_csv(path: Path, runs: Sequence[RunData]) -> None:
    """One line for every episode of every run, with success and SPL under every protocol.

    If there are lives, the last columns say which and the number of the goal in it.
    """
    lived = lives.has_lives(runs)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(
            [
                *("run", "scene_id", "episode_id", "goal", "group", "outcome", "failure", "why"),
                *("counts", "stopped", "steps", "path_length_m", "shortest_path_m"),
                *("explored_m", "approached_m", "shortest_from_sight_m"),
                *(
                    "distance_to_goal_m",
                    "distance_to_object_m",
                    "soft_spl",
                    "model_calls",
                    "tokens_in",
                    "tokens_out",
                ),
                "seconds",
                *(f"{name}_{_column(p)}" for p in PROTOCOLS for name in ("success", "spl")),
                *(("life", "goal_number") if lived else ()),
            ]
        )
        for run in runs:
            for r in run.records:
                scores = [protocol.score(r) for protocol in PROTOCOLS]
                writer.writerow(
                    [
                        *(run.name, r.scene_id, r.episode_id, r.goal, r.group, r.outcome.value),
                        *(r.failure.value if r.failure else "", r.why, int(r.counts)),
                        *(int(r.stopped), r.steps, _length(r.path_length_m)),
                        _length(r.shortest_path_m),
                        *(_length(r.explored_m), _length(r.approached_m)),
                        *(_length(r.shortest_from_sight_m), _length(r.distance_to_goal_m)),
                        _length(r.distance_to_object_m),
                        *(f"{r.soft_spl:.4f}", r.model_calls, r.tokens_in, r.tokens_out),
                        f"{r.seconds.get('total', 0.0):.3f}",
                        *(x for s in scores for x in (int(s.success), f"{s.spl:.4f}")),
                        *((r.life, r.goal_number if r.life else "") if lived else ()),
                    ]
                )


def write_tex(path: Path, runs: Sequence[RunData]) -> None:
    """The overall table and the one by scene, for a paper (package ``booktabs``)."""
    path.write_text(f"{_overall(runs)}\n{_by_scene(runs)}", encoding="utf-8")


def write_lives(path: Path, runs: Sequence[RunData]) -> None:
    """Every life of every run, and the results by number of the goal."""
    content = {
        "runs": {run.name: [asdict(life) for life in lives.life_records(run)] for run in runs},
        "by_goal_number": [asdict(row) for row in lives.by_goal_number(runs)],
        "against_the_first_run": {
            run.name: [asdict(pair) for pair in lives.paired_by_goal_number(runs[0], run)]
            for run in runs[1:]
        },
    }
    path.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


def tex(text: str) -> str:
    """Text escaped for LaTeX."""
    return text.translate(_TEX_SPECIAL)


def _overall(runs: Sequence[RunData]) -> str:
    told = runs[0].configuration
    distance = f"{told['protocol']['success_distance_m']:g}"
    lines = [
        r"\begin{tabular}{lcccr}",
        r"\toprule",
        r"Method & SR (\%) $\uparrow$ & SPL $\uparrow$ & SoftSPL $\uparrow$ & Episodes \\",
        r"\midrule",
    ]
    for run, summary in zip(runs, tables.overall(runs), strict=True):
        cells = [
            tex(run.name),
            with_interval(summary.success, 100.0, 1),
            with_interval(summary.spl, 1.0, 3),
            with_interval(summary.soft_spl, 1.0, 3),
            str(summary.success.count),
        ]
        lines.append(" & ".join(cells) + r" \\")
    lines += [
        r"\bottomrule",
        r"\end{tabular}",
        f"% {runs[0].dataset}; STOP within {distance} m (geodesic) of a view point, at most "
        f"{told['protocol']['max_steps']} steps; brackets: 95% bootstrap over "
        f"{drawn_in(runs)}",
    ]
    return "\n".join(lines) + "\n"


def _by_scene(runs: Sequence[RunData]) -> str:
    heads = " & ".join(rf"\multicolumn{{2}}{{c}}{{{tex(run.name)}}}" for run in runs)
    lines = [
        r"\begin{tabular}{lr" + "cc" * len(runs) + "}",
        r"\toprule",
        rf"Scene & Episodes & {heads} \\",
        " & " + "".join(r" & SR (\%) & SPL" for _ in runs) + r" \\",
        r"\midrule",
    ]
    for group in tables.by_scene(runs):
        cells = [tex(group.name), str(group.count)]
        for success, spl in zip(group.success, group.spl, strict=True):
            cells.append("--" if success is None else f"{100 * success.mean:.1f}")
            cells.append("--" if spl is None else f"{spl.mean:.3f}")
        lines.append(" & ".join(cells) + r" \\")
    return "\n".join([*lines, r"\bottomrule", r"\end{tabular}"]) + "\n"


def with_interval(estimate: Estimate, factor: float, digits: int) -> str:
    """A mean with its interval in brackets."""
    mean, low, high = (factor * v for v in (estimate.mean, estimate.low, estimate.high))
    return f"{mean:.{digits}f} [{low:.{digits}f}, {high:.{digits}f}]"


def _column(protocol: EvaluationProtocol) -> str:
    rule = "stop" if protocol.stop_rule is StopRule.STOP_REQUIRED else "timeout"
    of = "_object" if protocol.reference is Reference.OBJECT else ""
    return f"{protocol.success_distance_m:g}m{of}_{rule}"


def _length(value: float | None) -> str:
    return "" if value is None or math.isinf(value) else f"{value:.4f}"
