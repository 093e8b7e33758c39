"""The command `hypernav ablate`: what each part of a method is worth."""

import difflib
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from hypernav.cli.ablate_refinement import run_refinement
from hypernav.cli.eval import evaluate, folder_name
from hypernav.cli.guards.crashes import crash_report
from hypernav.cli.guards.outputs import check_folder
from hypernav.cli.guards.statuses import ExitStatus
from hypernav.cli.options.ablate import Options
from hypernav.cli.run_choice import check, config_of, planned
from hypernav.cli.screen.eval_table import result_line
from hypernav.cli.screen.terminal import Terminal
from hypernav.core.errors import ConfigError
from hypernav.evaluation.ablation.ablation_page import write_ablation
from hypernav.evaluation.ablation.model_quality import STUDIES
from hypernav.evaluation.ablation.study import Method, Study, Variant, slug
from hypernav.evaluation.choices import StudyName
from hypernav.evaluation.runner import check_scored, crash_of
from hypernav.evaluation.store.run_store import held_folder


def run(options: Options) -> int:
    """Run the command.

    Returns:
        The status of success: every episode of every variant is done.

    Raises:
        HyPerNavError: A run cannot be started, or stopped before its end.
        ReportedCrashError: The program failed in some of the episodes.
    """
    check(options)
    return _WORK[options.study](options)


def _run_variants(options: Options) -> ExitStatus:
    """Run every variant of a study as an evaluation of its own, and write the page."""
    who = options.who
    study = STUDIES[options.study](Method(who.preset, config_of(options), who.specs))
    study = replace(study, variants=_chosen(study, options.only))
    if options.list:
        who.build(config_of(options)).close()  # raises if the method cannot be built
        _show(study, with_left_out=options.only is None)
        return ExitStatus.SUCCESS
    name = f"{options.dataset}-{who.name}-{who.preset}-{options.study}"
    folder = options.out or Path("runs") / f"{folder_name(name)}-ablation"
    check_folder(folder)
    console = Terminal(quiet=options.quiet)
    with crash_report(folder), held_folder(folder, _configuration(options, console)):
        try:
            for place, variant in enumerate(study.variants, start=1):
                heading = f"variant {place} of {len(study.variants)}: {variant.name}"
                _run(variant, options, folder, console, heading)
        finally:  # after errors, too, write the results so far
            page = write_ablation(folder, study)
            if page is not None:
                console.print(f"open {page}", soft_wrap=True, markup=False)
    return ExitStatus.SUCCESS


def _configuration(options: Options, console: Terminal) -> dict[str, Any]:
    """What a folder is for: the configuration of the unchanged method, and the study."""
    plan, episodes = planned(options, console)
    return plan.configuration(episodes) | {"study": options.study}


def _run(variant: Variant, options: Options, folder: Path, console: Terminal, heading: str) -> None:
    who = replace(
        options.who, set=(*options.who.set, *variant.assignments), **dict(variant.components)
    )
    progress = evaluate(replace(options, who=who), folder / variant.slug, console, heading=heading)
    if progress.crashes:
        raise crash_of(progress)
    check_scored(progress)
    console.print(f"  {result_line(progress)}", soft_wrap=True)


def _chosen(study: Study, only: str | None) -> tuple[Variant, ...]:
    """The unchanged method and the variants of these names, or all."""
    first, *others = study.variants
    if only is None:
        return study.variants
    names = [slug(name) for name in only.split(",")]
    known = {variant.slug: variant for variant in others}
    for name in names:
        if name in known or name == first.slug:
            continue
        for one in study.left_out:
            if one.variant.slug == name:
                raise ConfigError(f"--only {name}: this variant is left out, because {one.why}")
        close = difflib.get_close_matches(name, known, n=1)
        hint = f"did you mean '{close[0]}'? " if close else ""
        raise ConfigError(f"--only: unknown variant '{name}'; {hint}variants: {', '.join(known)}")
    return (first, *(variant for name, variant in known.items() if name in names))


def _show(study: Study, *, with_left_out: bool) -> None:
    console = Terminal(stderr=False, soft_wrap=True)
    for variant in study.variants:
        console.print(f"{variant.slug}: {variant.words}", markup=False)
        if variant.changes:
            console.print(f"    {variant.changes}", markup=False)
    for one in study.left_out if with_left_out else ():
        console.print(f"left out: {one.variant.slug} ({one.why})", markup=False)


_WORK: dict[StudyName, Callable[[Options], ExitStatus]] = {
    "switches": _run_variants,
    "model": _run_variants,
    "refinement": run_refinement,
}
"""What the command does for each study."""
