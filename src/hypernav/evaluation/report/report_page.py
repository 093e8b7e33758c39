"""HTML report of one run, or of several side by side."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

import yaml

from hypernav.core.errors import RunFolderError
from hypernav.core.text.counted import number_of
from hypernav.evaluation.failures.classification import RULES, Failure
from hypernav.evaluation.protocol import PROTOCOLS, StopRule
from hypernav.evaluation.record import EpisodeRecord
from hypernav.evaluation.report import goat_rules, lives, report_text, tables
from hypernav.evaluation.report.beside_paper import beside_paper
from hypernav.evaluation.report.costs import call_axis, costs
from hypernav.evaluation.report.published_results import PUBLISHED
from hypernav.evaluation.report.run_data import RunData
from hypernav.evaluation.report.table_files import write_csv, write_lives, write_tex
from hypernav.show import captions
from hypernav.show.templating import page_environment, plain

REPORT_FILES = ("report.html", "report.csv", "report.tex", "lives.json")
"""Names of the files that `write_report` writes."""
_SHOWN_FAILURES = 200


def write_report(
    folder: Path, runs: Sequence[RunData], *, compare: bool = False, published: bool = False
) -> Path:
    """Write ``report.html``, ``report.csv``, ``report.tex``, and ``lives.json`` if there are lives.

    Args:
        folder: Folder of the report; created if missing.
        runs: Runs to report, at least one.
        compare: Whether to compare every run with the first one, episode by episode.
        published: Whether to set every run beside the HyPerNav paper's rows.

    Returns:
        Path of the page; it needs no network, but links to the pages of saved episodes.

    Raises:
        RunFolderError: Runs to be compared share no episode, or the folder can't be written.
    """
    pairs = [tables.pair(runs[0], other) for other in runs[1:]] if compare else []
    if missing := [p for p in pairs if p.count == 0]:
        raise RunFolderError(
            f"{missing[0].first} and {missing[0].second} have no episode in common; only runs of "
            "the same data set can be compared"
        )
    page = page_environment("hypernav.evaluation").get_template("report.html.j2")
    beside = [(run, beside_paper(run)) for run in runs] if published else []
    text = page.render(beside=beside, **_content(folder, runs, pairs))
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "report.html").write_text(text, encoding="utf-8")
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
        "goat_rules": list(goat_rules.GOAT_RULES),
        "goat": [
            (run, goat_rules.by_goal_type(run)) for run in runs if goat_rules.has_goal_types(run)
        ],
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
