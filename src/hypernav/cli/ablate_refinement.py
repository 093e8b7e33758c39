"""The study of goal refinement, `hypernav ablate --study refinement`."""

from dataclasses import asdict
from pathlib import Path

from hypernav.build.construction import asked_by
from hypernav.build.registries import DETECTORS, SEGMENTERS
from hypernav.cli.eval import folder_name
from hypernav.cli.guards.crashes import crash_report
from hypernav.cli.guards.outputs import check_folder
from hypernav.cli.guards.statuses import ExitStatus
from hypernav.cli.options.ablate import Options
from hypernav.cli.run_choice import config_of, plan_of
from hypernav.cli.screen.terminal import Terminal
from hypernav.core.errors import ConfigError
from hypernav.core.text.counted import number_of
from hypernav.evaluation.refinement.area_record import EpisodeAreas
from hypernav.evaluation.refinement.page import result_lines, write_refinement
from hypernav.evaluation.refinement.study import run_refinement_study
from hypernav.evaluation.store.record_file import RecordFile
from hypernav.evaluation.store.run_store import EPISODES_FILE, held_folder


def run_refinement(options: Options) -> ExitStatus:
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


def _check(options: Options) -> None:
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
