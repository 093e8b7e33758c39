"""The command `hypernav houses`: generated buildings, their splits and their episodes."""

from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from hypernav.app.cli.guards.crashes import ExitStatus
from hypernav.app.cli.guards.outputs import check_file, check_folder
from hypernav.app.cli.options.commands import Episodes, Export, Show, Splits
from hypernav.app.cli.screen.terminal import Terminal
from hypernav.core.errors import ConfigError, EpisodeError
from hypernav.core.interruptions import interruptions_of_kernels
from hypernav.core.naming.words import is_whole_number, number_of
from hypernav.lab.datasets.building_splits import SPLITS, numbers_of, split_named
from hypernav.simulator.houses.building import NOUNS, Building
from hypernav.simulator.houses.episodes.splits import Difficulty, difficulty, load_split
from hypernav.simulator.houses.export.building_files import export_building, write_dataset_config
from hypernav.simulator.houses.export.building_page import building_page
from hypernav.simulator.houses.export.habitat_data import (
    HabitatData,
    export_split,
    is_file_name,
    write_split,
)
from hypernav.simulator.houses.named_scenes import building_of


def run(options: Show | Export | Episodes | Splits) -> int:
    """Run the command.

    Returns:
        The status of success.
    """
    match options:
        case Show():
            _show(options)
        case Export():
            _export(options)
        case Episodes():
            _episodes(options)
        case Splits():
            _splits()
    return ExitStatus.SUCCESS


def _episodes(options: Episodes) -> None:
    split_named(options.split)
    numbers = None if options.houses is None else _range_of(options.houses)
    _check_writable(options.out)
    console = Terminal(quiet=options.quiet)
    with _progress(console) as bar:
        task = bar.add_task("measuring buildings", total=None)
        dataset = load_split(
            options.split,
            numbers=numbers,
            count=options.count,
            progress=lambda done, total: bar.update(task, completed=done, total=total),
        )
        task = bar.add_task("finding view points", total=None)
        write_split(
            dataset,
            options.out,
            progress=lambda done, total: bar.update(task, completed=done, total=total),
        )
    _say(console, difficulty(dataset))
    console.print(f"  wrote {options.out}", soft_wrap=True)


def _splits() -> None:
    table = Table("split", "buildings", "episodes", "goals")
    for split in SPLITS.values():
        numbers = f"{split.kind} {split.numbers.start}:{split.numbers.stop}"
        others = (
            " by default; others, but for the exam's and other splits'" if split.is_open else ""
        )
        table.add_row(split.name, numbers + others, str(split.episodes), split.style)
    Terminal(stderr=False).print(table)


def _export(options: Export) -> None:
    split, hash_sign, part = options.what.partition("#")
    if split.partition("-")[0] in NOUNS:
        if hash_sign and not part:
            raise EpisodeError(f"{split}#: nothing follows the #; say which buildings")
        _export_split(options, split_named(split).name, part)
    else:
        _export_building(options)


def _export_split(options: Export, split: str, part: str) -> None:
    numbers = numbers_of(split, part) if part else None
    root = Path("runs") / split if options.out is None else options.out
    check_folder(root)
    console = Terminal(quiet=options.quiet)
    data = HabitatData(root, split)
    try:
        with interruptions_of_kernels(), _progress(console) as bar:
            task = bar.add_task("measuring buildings", total=None)
            dataset = load_split(
                split,
                numbers=numbers,
                progress=lambda done, total: bar.update(task, completed=done, total=total),
            )
            task = bar.add_task("writing buildings", total=None)
            export_split(
                dataset,
                split,
                root,
                progress=lambda done, total: bar.update(task, completed=done, total=total),
            )
    except KeyboardInterrupt:
        console.print(
            f"interrupted; buildings of {split} that are complete in {root}: "
            f"{len(data.buildings)}. Run the same command again",
            soft_wrap=True,
        )
        raise
    console.print(
        f"{len(dataset.episodes)} episodes of {split} written; {root} holds "
        f"{len(data.buildings)} of its buildings; for habitat-lab:\n"
        f"  habitat.dataset.data_path={data.episodes}\n"
        f"  habitat.dataset.scenes_dir={data.scenes}\n"
        f"  habitat.simulator.scene_dataset={data.dataset_config}\n"
        f"  try: hypernav eval habitat:{data.episodes}",
        soft_wrap=True,
    )


def _export_building(options: Export) -> None:
    building = building_of(options.what)
    folder = _folder_for(building) if options.out is None else options.out
    check_folder(folder)
    console = Terminal(quiet=options.quiet)
    words = f"building {building.noun} {building.number}, to be written to {folder} …"
    console.print(words, soft_wrap=True)
    try:
        with interruptions_of_kernels():
            files = export_building(building, folder)
            dataset_config = write_dataset_config(folder)
    except KeyboardInterrupt:
        console.print(
            f"interrupted; {folder} is not complete. Run the same command again", soft_wrap=True
        )
        raise
    console.print(f"{building.noun} {building.number} in {folder}:", soft_wrap=True)
    for path, what in (
        (files.glb, f"the {building.noun}; opens in Blender, web viewers and hypernav"),
        (files.objects, "names and categories of its nodes"),
        (dataset_config, "for Habitat's scene_dataset_config_file"),
        (files.semantic_glb, "its instances in colours, for Habitat's semantic sensor"),
        (files.semantic_txt, "the instances of these colours"),
        (files.navmesh, "where Habitat's robot can stand"),
    ):
        size = f"{path.stat().st_size / 1e6:.1f} MB"
        console.print(f"  {path.name:34} {size:>8}  {what}", soft_wrap=True)
    console.print(f"  try: hypernav find bed --scene {files.glb}", soft_wrap=True)


def _show(options: Show) -> None:
    building = building_of(options.building)
    out = _folder_for(building) if options.out is None else options.out
    check_file(out) if out.suffix == ".html" else check_folder(out)
    console = Terminal(quiet=options.quiet)
    with interruptions_of_kernels(), _progress(console) as bar:
        task = bar.add_task(f"drawing {building.noun} {building.number}", total=None)
        page = building_page(
            building,
            out,
            progress=lambda done, total: bar.update(task, completed=done, total=total),
        )
    console.print(f"{building.noun} {building.number}: open {page}", soft_wrap=True)


def _folder_for(building: Building) -> Path:
    return Path("runs") / f"{building.noun}-{building.number}"


def _range_of(text: str) -> range:
    """The numbers that a text such as 1000:1004 names."""
    first, colon, end = text.partition(":")
    if not colon or not (is_whole_number(first) and is_whole_number(end)):
        raise ConfigError(f"--houses {text:.40}: expected FIRST:END, for example 1000:1004")
    return range(int(first), int(end))


def _check_writable(path: Path) -> None:
    """Refuse a path that cannot be written, before the buildings are measured."""
    if not is_file_name(path) and path.suffix:
        raise EpisodeError(
            f"{path}: an episode file ends in .json.gz or .json; a folder's name has no ending"
        )
    check_file(path) if is_file_name(path) else check_folder(path)


def _progress(console: Console) -> Progress:
    """A progress bar on a terminal; nothing in log files."""
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        console=console,
        transient=True,
        disable=console.quiet or not console.is_terminal,
    )


def _say(console: Console, found: Difficulty) -> None:
    table = Table(
        title=f"{number_of(found.episodes, 'episode')} in {number_of(found.buildings, 'building')}",
        title_justify="left",
    )
    table.add_column("")
    for head in ("least", "10%", "median", "90%", "most", "mean"):
        table.add_column(head, justify="right")
    for distribution in found.distributions:
        values = (*distribution.quantiles, distribution.mean)
        table.add_row(distribution.measure, *(f"{value:.2f}" for value in values))
    console.print(table)
    if found.vocabulary:
        words = ", ".join(f"{count} {name}" for name, count in found.vocabulary.items())
        console.print(f"  names: {words}; {found.descriptions} descriptions")
