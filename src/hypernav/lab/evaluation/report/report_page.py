"""HTML report of one run, or of several side by side, and the tables beside it.

The tables are every episode as CSV, the main tables as LaTeX, and lives as JSON.
"""

import csv
import json
import math
import os
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any
from urllib.parse import quote

import yaml

from hypernav.app.show import captions
from hypernav.app.show.templating import page_environment, plain
from hypernav.core.errors import RunFolderError
from hypernav.core.naming.words import number_of
from hypernav.io.writing import csv_file, write_whole
from hypernav.lab.evaluation.failures import RULES, Failure
from hypernav.lab.evaluation.protocol import PROTOCOLS, EvaluationProtocol, Reference, StopRule
from hypernav.lab.evaluation.record import EpisodeRecord
from hypernav.lab.evaluation.report import lives, report_text, tables
from hypernav.lab.evaluation.report.published_results import PUBLISHED, beside_paper
from hypernav.lab.evaluation.report.report_text import drawn_in
from hypernav.lab.evaluation.report.run_data import RunData, call_axis, costs
from hypernav.lab.evaluation.statistics import Estimate

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
    with csv_file(path) as file:
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
    write_whole(path, f"{_overall(runs)}\n{_by_scene(runs)}")


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
    write_whole(path, json.dumps(content, indent=1) + "\n")


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
    """A mean, with its interval in brackets where that says something."""
    brackets = report_text.interval(estimate, factor, " [{}, {}]", digits)
    return f"{factor * estimate.mean:.{digits}f}{brackets}"


def _column(protocol: EvaluationProtocol) -> str:
    rule = "stop" if protocol.stop_rule is StopRule.STOP_REQUIRED else "timeout"
    of = "_object" if protocol.reference is Reference.OBJECT else ""
    return f"{protocol.success_distance_m:g}m{of}_{rule}"


def _length(value: float | None) -> str:
    return "" if value is None or math.isinf(value) else f"{value:.4f}"


REPORT_FILES = ("report.html", "report.csv", "report.tex", "lives.json")
"""Names of the files that `write_report` writes."""
_SHOWN_FAILURES = 200


def write_report(
    folder: str | Path,
    runs: Sequence[RunData],
    *,
    pairs: Sequence[tables.Pair] = (),
    published: bool = False,
) -> Path:
    """Write ``report.html``, ``report.csv``, ``report.tex``, and ``lives.json`` if there are lives.

    Args:
        folder: Folder of the report; created if missing.
        runs: Runs to report, at least one.
        pairs: Comparisons to show, such as `tables.pairs` of these runs.
        published: Whether to set every run beside the HyPerNav paper's rows.

    Returns:
        Path of the page; it needs no network, but links to the pages of saved episodes.

    Raises:
        RunFolderError: The folder can't be written.
    """
    folder = Path(folder)
    page = page_environment("hypernav.lab.evaluation").get_template("report.html.j2")
    beside = [(run, beside_paper(run)) for run in runs] if published else []
    text = page.render(beside=beside, **_content(folder, runs, pairs))
    try:
        folder.mkdir(parents=True, exist_ok=True)
        write_whole(folder / "report.html", text)
        write_csv(folder / "report.csv", runs)
        write_tex(folder / "report.tex", runs)
        if lives.has_lives(runs):
            write_lives(folder / "lives.json", runs)
    except OSError as error:
        raise RunFolderError(f"{folder} cannot be written: {error.strerror or error}") from error
    return folder / "report.html"


def _content(folder: Path, runs: Sequence[RunData], pairs: Sequence[tables.Pair]) -> dict[str, Any]:
    summaries = tables.overall(runs)
    cost_rows = costs(runs)
    lived = lives.has_lives(runs)
    return {
        "runs": runs,
        "title": report_text.title(runs),
        "lead": report_text.lead(runs, summaries),
        "drawn": report_text.drawn_in(runs),
        "warnings": report_text.warnings(runs),
        "summaries": list(zip(runs, summaries, strict=True)),
        "pairs": pairs,
        "verdicts": [report_text.verdict(pair) for pair in pairs],
        "reaches": list(dict.fromkeys(protocol.reached for protocol in PROTOCOLS)),
        "stop_rules": list(StopRule),
        "matrices": [(run, tables.protocol_matrix(run)) for run in runs],
        "goal_numbers": lives.by_goal_number(runs) if lived else [],
        "goal_number_pairs": [
            (run, lives.paired_by_goal_number(runs[0], run)) for run in runs[1:] if lived
        ],
        "lives": [(run, lives.life_records(run)) for run in runs if lived],
        "goat_rules": list(lives.GOAT_RULES),
        "goat": [(run, lives.by_goal_type(run)) for run in runs if lives.has_goal_types(run)],
        "own": [tables.own_protocol(run) for run in runs],
        "metres": list(zip(runs, tables.metres(runs), strict=True)),
        "failures": tables.failures(runs),
        "rules": [(failure, _rule_words(failure)) for failure, _ in RULES],
        "failed": _failed(folder, runs),
        "shown_failures": _SHOWN_FAILURES,
        "by_distance": tables.by_distance(runs),
        "by_goal": tables.by_goal(runs),
        "by_part": tables.by_part(runs),
        "by_scene": tables.by_scene(runs),
        "modules": tables.module_times(runs),
        "costs": list(zip(runs, cost_rows, strict=True)),
        "call_axis": call_axis(cost_rows),
        "questions": tables.questions_a_step(runs),
        "calls": [_calls(run) for run in runs],
        "protocol": report_text.protocol_lines(runs[0]),
        "other_protocols": [(r, report_text.other_protocol_lines(r, runs[0])) for r in runs[1:]],
        "configurations": [(run, _yaml(run.configuration)) for run in runs],
        "published": PUBLISHED,
        "saved": _saved(folder, runs),
        "sessions": [(run, report_text.session_lines(run)) for run in runs],
        "captions": captions,
        "report_text": report_text,
        "number_of": number_of,
    }


def _failed(folder: Path, runs: Sequence[RunData]) -> list[tuple[RunData, EpisodeRecord, str]]:
    """All failed episodes with their pages at the step that decided them, by run."""
    return [
        (run, record, _link(folder, run, record, part="#decisive"))
        for run in runs
        for record in sorted(run.records, key=lambda r: r.key)
        if record.failure is not None
    ]


def _saved(folder: Path, runs: Sequence[RunData]) -> list[tuple[RunData, EpisodeRecord, str]]:
    """All saved episodes with their pages, by run."""
    return [
        (run, record, _link(folder, run, record))
        for run in runs
        for record in sorted(run.records, key=lambda r: r.key)
        if record.saved
    ]


def _link(folder: Path, run: RunData, record: EpisodeRecord, *, part: str = "") -> str:
    """Address of an episode's page as seen from the report, empty if it was not saved."""
    if not record.saved:
        return ""
    page = run.folder.resolve() / record.saved / "index.html"
    return quote(Path(os.path.relpath(page, folder.resolve())).as_posix()) + part


def _calls(run: RunData) -> dict[str, float]:
    episodes, steps = len(run.records), max(sum(r.steps for r in run.records), 1)
    calls = sum(record.model_calls for record in run.records)
    return {
        "total": calls,
        "per_episode": calls / episodes,
        "per_step": calls / steps,
        "tokens_in": sum(record.tokens_in for record in run.records),
        "tokens_out": sum(record.tokens_out for record in run.records),
    }


def _rule_words(failure: Failure) -> str:
    rule, in_paper = report_text.RULES_IN_WORDS[failure], failure.in_paper
    return f"{rule} Class of the HyPerNav paper: {in_paper}." if in_paper else rule


def _yaml(configuration: object) -> str:
    return yaml.safe_dump(plain(configuration), sort_keys=False, allow_unicode=True)
