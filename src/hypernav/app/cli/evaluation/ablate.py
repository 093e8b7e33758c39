"""The command `hypernav ablate`: what each part of a method is worth; and goal refinement."""

import difflib
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from hypernav.app.build.components.construction import asked_by
from hypernav.app.build.components.registries import DETECTORS, SEGMENTERS
from hypernav.app.cli.evaluation.eval import evaluate, folder_name, result_line
from hypernav.app.cli.evaluation.run_choice import check, config_of, plan_of, planned
from hypernav.app.cli.guards.crashes import ExitStatus, crash_report
from hypernav.app.cli.guards.outputs import check_folder
from hypernav.app.cli.options.commands import AblateOptions
from hypernav.app.cli.screen.terminal import Terminal
from hypernav.core.errors import ConfigError
from hypernav.core.naming.words import number_of
from hypernav.io.writing import own_folder
from hypernav.lab.evaluation.ablation.ablation_page import write_ablation
from hypernav.lab.evaluation.ablation.model_quality import STUDIES
from hypernav.lab.evaluation.ablation.study import Method, Study, Variant, slug
from hypernav.lab.evaluation.choices import StudyName
from hypernav.lab.evaluation.refinement.area_record import EpisodeAreas
from hypernav.lab.evaluation.refinement.page import result_lines, write_refinement
from hypernav.lab.evaluation.refinement.study import run_refinement_study
from hypernav.lab.evaluation.runner import check_scored, crash_of
from hypernav.lab.evaluation.store.record_file import RecordFile
from hypernav.lab.evaluation.store.run_store import EPISODES_FILE, held_folder


def run_refinement(options: AblateOptions) -> ExitStatus:
    """Study the goal areas of all episodes in this process, and write the page.

    Raises:
        ConfigError: An option has no meaning here.
        HyPerNavError: The study can't be started, or stopped before its end.
    """
    _check(options)
    who, config = options.who, config_of(options)
    folder = options.out or Path("runs") / folder_name(f"{options.dataset}-{who.preset}-refinement")
    check_folder(folder)
    console = Terminal(quiet=options.quiet)
    with crash_report(folder), console.status("loading the episodes …") as status:
        plan = plan_of(options, config)
        episodes = plan.episodes()
        told = plan.configuration(episodes) | {"study": "refinement", "parts": asdict(who.specs)}
        with held_folder(folder, told):
            records = run_refinement_study(
                episodes,
                RecordFile(folder / EPISODES_FILE, EpisodeAreas),
                config,
                who.specs,
                seed=options.seed,
                watch=lambda done, total: status.update(f"{done} of {total} episodes …"),
            )
    seen = len({(record.scene_id, record.episode_id) for record in records})
    lead = (
        f"What the preset {who.preset} makes of boxes of the goal, raw and refined, in the "
        f"{seen} of {number_of(len(episodes), 'episode')} of {options.dataset} that show it within "
        f"the range of depth; refined by {who.segmenter or 'depth-cut'}."
    )
    page = write_refinement(folder, records, lead=lead)
    for line in result_lines(records):
        console.print(line, soft_wrap=True)
    console.print(f"open {page}", soft_wrap=True)
    return ExitStatus.SUCCESS


def _check(options: AblateOptions) -> None:
    """Refuse options of variants and workers, and components that need more than the image."""
    given = {
        "--only": options.only is not None,
        "--list": options.list,
        "--workers": options.workers not in (None, 1),
        "--ray": options.ray is not None,
        "--save": options.save != "none",
    }
    if wrong := [name for name, is_given in given.items() if is_given]:
        raise ConfigError(
            f"{wrong[0]} has no meaning for --study refinement, which has no variants and runs in "
            "one process; leave it out"
        )
    specs = options.who.specs
    for kind, spec, registry in (
        ("detector", specs.detector, DETECTORS),
        ("segmenter", specs.segmenter, SEGMENTERS),
    ):
        asked = {} if spec is None else asked_by(registry.find(spec))
        if wanted := [name for name, is_needed in asked.items() if is_needed and name != "config"]:
            raise ConfigError(
                f"--{kind} {spec} doesn't work with --study refinement, which gives a {kind} only "
                f"the image, and it needs more ({wanted[0]}); choose another or leave it out"
            )


def run(options: AblateOptions) -> int:
    """Run the command.

    Returns:
        The status of success: every episode of every variant is done.

    Raises:
        HyPerNavError: A run cannot be started, or stopped before its end.
        ReportedCrashError: The program failed in some of the episodes.
    """
    check(options)
    return _WORK[options.study](options)


def _run_variants(options: AblateOptions) -> ExitStatus:
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


def _configuration(options: AblateOptions, console: Terminal) -> dict[str, Any]:
    """What a folder is for: the configuration of the unchanged method, and the study."""
    plan, episodes = planned(options, console)
    return plan.configuration(episodes) | {"study": options.study}


def _run(
    variant: Variant, options: AblateOptions, folder: Path, console: Terminal, heading: str
) -> None:
    who = replace(
        options.who, set=(*options.who.set, *variant.assignments), **dict(variant.components)
    )
    own = own_folder(folder, variant.slug)
    progress = evaluate(replace(options, who=who), own, console, heading=heading)
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


_WORK: dict[StudyName, Callable[[AblateOptions], ExitStatus]] = {
    "switches": _run_variants,
    "model": _run_variants,
    "refinement": run_refinement,
}
"""What the command does for each study."""
