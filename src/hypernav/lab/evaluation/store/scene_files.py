"""Hashes of the scenes' files, kept in the folder of a run (``scenes.json``).

Episodes of a scene are comparable only as long as its files are the same. The files may still be
repaired while no episode of the scene is done, and folders of earlier versions, without hashes,
can be continued. Files are read again only if their sizes or times have changed.
"""

import hashlib
import json
from collections.abc import Iterable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from hypernav.app.build.data.sources import Progress
from hypernav.core.episode import Episode
from hypernav.core.errors import RunFolderError, SceneError
from hypernav.io.parsing import parse_json
from hypernav.io.reading import read_file
from hypernav.lab.evaluation.store.record_file import write_whole
from hypernav.lab.evaluation.store.run_store import RunStore

SCENES_FILE = "scenes.json"

_DIGITS = 16


@dataclass(frozen=True)
class _SceneFiles:
    """Hash and stamp of a scene's files.

    Attributes:
        hash: Hash of their content.
        stamp: Their sizes and times when hashed; empty in folders of earlier versions.
    """

    hash: str
    stamp: str = ""

    @staticmethod
    def of(mesh: Path, known: "_SceneFiles | None") -> "_SceneFiles":
        """The hash of a scene's present files, which are read only if they may have changed.

        Raises:
            SceneError: A file cannot be read.
        """
        files = _files_of(mesh)
        stamp = _stamp(files)
        return known if known and known.stamp == stamp else _SceneFiles(_digest(files), stamp)


def keep_scenes(
    store: RunStore, episodes: Iterable[Episode], progress: Progress | None = None
) -> None:
    """Write down the hashes of a run's scenes, or compare them with those at its beginning.

    Args:
        store: Store of the run, open.
        episodes: All episodes of the run; scenes without files, such as houses, are left out.
        progress: Function that is called with the numbers of scenes read so far and of all.

    Raises:
        RunFolderError: A scene in which an episode is done has other files now.
        SceneError: A file cannot be read.
    """
    path = store.folder / SCENES_FILE
    known = _read(path)
    scenes = dict.fromkeys(episode.scene_id for episode in episodes)
    meshes = [scene for scene in scenes if Path(scene).is_file()]
    found = {}
    for number, scene in enumerate(meshes):
        if progress is not None:
            progress(number, len(meshes))
        found[scene] = _SceneFiles.of(Path(scene), known.get(scene))
    done = {record.scene_id for record in store.records.values()}
    both = done & known.keys() & found.keys()
    changed = sorted(scene for scene in both if known[scene].hash != found[scene].hash)
    if changed:
        more = f" and {len(changed) - 1} more" if len(changed) > 1 else ""
        raise RunFolderError(
            f"{store.folder} was begun with other files of the scene {changed[0]}{more}: mesh, "
            "navmesh or annotation changed since episodes were done in it. Bring them back, or "
            "choose another --out"
        )
    if found != known:
        content = {scene: asdict(files) for scene, files in (known | found).items()}
        write_whole(path, json.dumps(content, indent=1) + "\n")


def _read(path: Path) -> dict[str, _SceneFiles]:
    try:
        content = parse_json(read_file(path))
    except FileNotFoundError:
        return {}
    except (OSError, ValueError) as error:
        raise RunFolderError(f"{path} cannot be read: {error}") from error
    try:
        return {scene: _remembered(files) for scene, files in content.items()}
    except (AttributeError, TypeError) as error:
        raise RunFolderError(f"{path} holds no scenes; was it edited?") from error


def _remembered(files: Any) -> _SceneFiles:
    # A bare hash is what earlier versions wrote.
    return _SceneFiles(files) if isinstance(files, str) else _SceneFiles(**files)


def _files_of(mesh: Path) -> list[Path]:
    """The existing files of a scene, its mesh first."""
    # imported here: a run of generated buildings reads no scans
    from hypernav.simulator.worlds.scans.scan_loading import ScanFiles
    from hypernav.simulator.worlds.scenes.loading import OBJECTS_FILE

    scan = ScanFiles.of(mesh)
    beside = (
        (mesh.with_name(OBJECTS_FILE),)
        if scan is None
        else (scan.semantic_mesh, scan.semantic_text, scan.navmesh)
    )
    return [mesh, *(path for path in beside if path is not None and path.is_file())]


def _stamp(files: Iterable[Path]) -> str:
    """Sizes and times of files."""
    found = []
    for path in files:
        try:
            status = path.stat()
        except OSError as error:
            raise _unreadable(path, error) from error
        found.append(f"{path.name}:{status.st_size}:{status.st_mtime_ns}")
    return " ".join(found)


def _digest(files: Iterable[Path]) -> str:
    """A hash of the content of files."""
    whole = hashlib.sha256()
    for path in files:
        try:
            with path.open("rb") as file:
                whole.update(hashlib.file_digest(file, "sha256").digest())
        except OSError as error:
            raise _unreadable(path, error) from error
    return whole.hexdigest()[:_DIGITS]


def _unreadable(path: Path, error: OSError) -> SceneError:
    return SceneError(f"{path}: cannot be read ({error.strerror or error})")
