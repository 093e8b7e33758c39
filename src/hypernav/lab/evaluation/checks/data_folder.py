"""Examines a data folder before a long run: what of each benchmark is there, what is missing."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from hypernav.core.errors import EpisodeError, SceneError
from hypernav.core.naming.words import number_of
from hypernav.lab.datasets.benchmark_files import (
    SCENES_FOLDER,
    SplitFolder,
    episode_folders,
    found_splits,
    parts_of,
    scene_below,
    scene_folders,
)
from hypernav.lab.datasets.benchmarks import BENCHMARKS, GENERATED, Benchmark
from hypernav.lab.datasets.goat import RUNNABLE, goal_type_words
from hypernav.lab.datasets.habitat_files import CONTENT, episode_files, read_as
from hypernav.lab.evaluation.checks.findings import Finding, State
from hypernav.simulator.worlds.navmesh.navmesh_reader import read_navmesh
from hypernav.simulator.worlds.scans.scan_loading import ScanFiles
from hypernav.simulator.worlds.scenes.gltf_file import check_glb

_PUBLISHED = tuple(BENCHMARKS[name] for name in ("hm3d", "mp3d", "ovon", "goat"))
_NAMED = 4
"""Largest number of missing scenes or broken files that are named."""
_BASIS = ".basis.glb"
_PARTS = (SCENES_FOLDER, "datasets")
"""Folders of Habitat's data, each of which holds only one part."""


def check_data(folder: Path) -> Iterator[Finding]:
    """Examine a data folder and yield findings; every episode file is read.

    Args:
        folder: Data folder, as in ``hm3d:DIR``.
    """
    if not folder.is_dir():
        yield Finding(
            "folder", State.FAULT, f"{folder} is no folder", "name the folder of all data"
        )
        return
    here = folder.resolve()
    if here.name in _PARTS and all((here.parent / part).is_dir() for part in _PARTS):
        words = f"{folder} holds one part of the data only"
        yield Finding("folder", State.FAULT, words, f"name the folder above it: {here.parent}")
        return
    used: dict[Path, Benchmark] = {}
    all_kinds = (*_PUBLISHED, GENERATED)
    begun = [one for one in all_kinds if episode_folders(one, folder)]
    for benchmark in all_kinds:
        if benchmark in begun:
            splits = found_splits(benchmark, folder)
            yield from _missing_splits(benchmark, folder, splits)
            for split in splits:
                content = _read(benchmark, folder, split)
                yield from _check_split(benchmark, content)
                used |= {mesh: used.get(mesh, benchmark) for mesh in content.meshes}
        elif benchmark is not GENERATED:
            words = f"no episodes of {benchmark.title} in {folder / benchmark.episodes[0]}"
            yield Finding(benchmark.name, State.NOTE, words)
    yield from _check_files(used)
    yield from _scenes_alone(begun, folder)
    if not begun and not any(scene_folders(one, folder) for one in all_kinds):
        episodes = "; ".join(f"{one.title}: {one.episodes_from}" for one in _PUBLISHED)
        scenes = ", or ".join(dict.fromkeys(one.scenes_from for one in _PUBLISHED))
        remedy = f"get the episodes of one ({episodes}) and its scenes ({scenes})"
        yield Finding("folder", State.FAULT, f"{folder} holds no benchmark", remedy)


@dataclass(frozen=True)
class _SplitContent:
    """What the episode files of a split hold.

    Attributes:
        split: The split.
        count: Number of episodes.
        goals: Categories of their goals.
        files: Meshes of their scenes by the scenes' ids; None where one is missing.
        fault: Description of a broken file; empty if there is none.
        goal_types: Numbers of its goals by type, if it has several.
    """

    split: SplitFolder
    count: int = 0
    goals: frozenset[str] = frozenset()
    files: Mapping[str, Path | None] = field(default_factory=dict)
    fault: str = ""
    goal_types: Mapping[str, int] = field(default_factory=dict)

    @property
    def meshes(self) -> list[Path]:
        """The meshes that are there."""
        return [mesh for mesh in self.files.values() if mesh is not None]


class _MainFile(BaseModel):
    """The file of a whole split, of whatever benchmark."""

    episodes: list[Any]


def _read(benchmark: Benchmark, folder: Path, split: SplitFolder) -> _SplitContent:
    count, scenes, goals, types = 0, dict[str, None](), set[str](), Counter[str]()
    try:
        for episodes in parts_of(benchmark, split.path):
            count += len(episodes)
            if benchmark.goal_types:
                types.update(episode.group for episode in episodes)
            scenes.update(dict.fromkeys(episode.scene_id for episode in episodes))
            goals.update(episode.object_category for episode in episodes)
        files = {scene_id: scene_below(benchmark, folder, scene_id) for scene_id in scenes}
    except EpisodeError as error:
        return _SplitContent(split, fault=str(error))
    return _SplitContent(split, count, frozenset(goals), files, goal_types=types)


def _missing_splits(
    benchmark: Benchmark, folder: Path, splits: Sequence[SplitFolder]
) -> Iterator[Finding]:
    """The finding about splits that should be there, if there is one."""
    names = {split.name for split in splits}
    missing = [name for name in benchmark.splits if name not in names]
    if missing:
        expected = folder / benchmark.episodes[0] / missing[0]
        state = State.NOTE if splits else State.FAULT
        words = f"no episodes of {', '.join(missing)}; expected {expected}"
        yield Finding(f"{benchmark.name} episodes", state, words, benchmark.episodes_from)


def _scenes_alone(begun: Sequence[Benchmark], folder: Path) -> Iterator[Finding]:
    """Findings about scenes without episodes of any of the benchmarks that share them."""
    for names in dict.fromkeys(one.scenes for one in _PUBLISHED):
        sharing = [one for one in _PUBLISHED if one.scenes == names]
        scenes = scene_folders(sharing[0], folder)
        if scenes and not any(one in begun for one in sharing):
            check = f"{' or '.join(one.name for one in sharing)} episodes"
            places = " or ".join(str(folder / one.episodes[0]) for one in sharing)
            words = f"no episodes for the scenes in {scenes[0]}; expected in {places}"
            remedy = "; or ".join(f"{one.title}: {one.episodes_from}" for one in sharing)
            yield Finding(check, State.FAULT, words, remedy)


def _check_split(benchmark: Benchmark, content: _SplitContent) -> Iterator[Finding]:
    split, files = content.split, content.files
    check = f"{benchmark.name} {split.version}/{split.name}"
    if content.fault:
        remedy = f"get the episodes again: {benchmark.episodes_from}"
        yield Finding(check, State.FAULT, content.fault, remedy)
        return
    nouns = ("goal of a life", "goals of lives") if content.goal_types else ("episode",)
    words = (
        f"{number_of(content.count, *nouns)} in {number_of(len(files), 'scene')}, "
        f"{number_of(len(content.goals), 'category', 'categories')}"
    )
    yield Finding(check, State.GOOD, words)
    yield from _check_main_file(check, split)
    if content.goal_types:
        yield _goal_types(check, content)
    yield from _check_scenes(benchmark, check, files)
    scans = [scan for mesh in content.meshes if (scan := ScanFiles.of(mesh)) is not None]
    yield from _check_scans(check, scans)
    if any(scan.mesh.name.endswith(_BASIS) for scan in scans):
        yield _textures(check)


def _check_main_file(check: str, split: SplitFolder) -> Iterator[Finding]:
    """The finding about the file of a split, which isn't read where each scene has its own."""
    if episode_files(split.path)[0].parent.name != CONTENT:
        return
    file = split.path / f"{split.path.name}.json.gz"
    try:
        count = len(read_as(_MainFile, file).episodes)
    except EpisodeError as error:
        words = str(error) if file.exists() else f"{file} is missing"
    else:
        if count == 0:
            return
        words = f"{file} holds {count:,} episodes"
    yield Finding(f"{check} main file", State.NOTE, f"{words}; runs read {CONTENT}/ alone")


def _goal_types(check: str, content: _SplitContent) -> Finding:
    """The finding about goals that can't be run."""
    counts = goal_type_words(content.goal_types)
    out = sum(n for kind, n in content.goal_types.items() if kind not in RUNNABLE)
    words = f"{counts}; {out:,} of them are left out of runs" if out else counts
    return Finding(f"{check} goals", State.NOTE if out else State.GOOD, words)


def _check_scenes(
    benchmark: Benchmark, check: str, files: Mapping[str, Path | None]
) -> Iterator[Finding]:
    """Findings about the scenes of a split, by their ids."""
    missing = [Path(scene_id).parent.name for scene_id, mesh in files.items() if mesh is None]
    if missing:
        some = ", ".join(missing[:_NAMED]) + (", …" if len(missing) > _NAMED else "")
        state = State.FAULT if len(missing) == len(files) else State.NOTE
        words = f"{len(files) - len(missing)} of {number_of(len(files), 'scene')}; missing: {some}"
        yield Finding(f"{check} scenes", state, words, f"get them {benchmark.scenes_from}")
    else:
        yield Finding(f"{check} scenes", State.GOOD, f"all {len(files)}")


def _check_files(used: Mapping[Path, Benchmark]) -> Iterator[Finding]:
    """Findings about files that are truncated or of another kind; splits share their scenes."""
    broken = [(error, benchmark) for mesh, benchmark in used.items() for error in _faults_of(mesh)]
    said = broken[:_NAMED]
    if len(broken) > _NAMED:
        said.append((f"{len(broken) - _NAMED} more files are broken", broken[-1][1]))
    for words, benchmark in said:
        remedy = f"get these scenes again {benchmark.scenes_from}"
        yield Finding(f"{benchmark.name} files", State.FAULT, words, remedy)


def _faults_of(mesh: Path) -> Iterator[str]:
    """Faults of a scene's files, judged by first bytes and sizes; navmeshes are read completely."""
    scan = ScanFiles.of(mesh) or ScanFiles(mesh, navmesh=mesh.with_suffix(".navmesh"))
    for file in (scan.mesh, scan.semantic_mesh, scan.navmesh):
        try:
            if file is not None and file.suffix == ".glb":
                check_glb(file)
            elif file is not None and file.suffix == ".navmesh" and file.is_file():
                read_navmesh(file)
        except SceneError as error:
            yield str(error)


def _check_scans(check: str, scans: list[ScanFiles]) -> Iterator[Finding]:
    """Findings about the files that come with the meshes."""
    meshes = sum(scan.navmesh is not None for scan in scans)
    if scans and meshes == len(scans):
        yield Finding(f"{check} navmeshes", State.GOOD, f"all {meshes}")
    elif scans:
        words = f"{meshes} of {len(scans)}; without one, floors are computed from the triangles"
        yield Finding(f"{check} navmeshes", State.NOTE, words)
    if not scans:
        return
    semantic = sum(
        scan.semantic_mesh is not None and scan.semantic_text is not None for scan in scans
    )
    if semantic == len(scans):
        yield Finding(f"{check} annotations", State.GOOD, f"all {semantic}")
    else:
        words = (
            f"{semantic} of {number_of(len(scans), 'scene')}; without them there is no ground "
            "truth, and results are the same"
        )
        yield Finding(f"{check} annotations", State.NOTE, words)


def _textures(check: str) -> Finding:
    if find_spec("opengl_basisu") is not None:
        return Finding(f"{check} textures", State.GOOD, "Basis Universal can be read")
    return Finding(
        f"{check} textures",
        State.FAULT,
        "Basis Universal can't be read",
        "pip install 'hypernav[hm3d]', or download the scenes with plain textures, too",
    )
