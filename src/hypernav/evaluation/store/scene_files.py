"""The files of scenes, as the folder of a run remembers them (``scenes.json``).

What is done in a scene stays comparable only as long as its files are the same. A scene in which
nothing is done yet may be mended, and folders of earlier versions, which remember none, go on.
"""

import hashlib
import json
from collections.abc import Iterable
from pathlib import Path

from hypernav.core.episode import Episode
from hypernav.core.errors import RunFolderError, SceneError
from hypernav.core.files.json_text import parse_json
from hypernav.core.files.reading import read_file
from hypernav.evaluation.store.append_only import write_whole
from hypernav.evaluation.store.run_store import RunStore
from hypernav.worlds.scans.layout import ScanFiles
from hypernav.worlds.scenes.loading import OBJECTS_FILE

SCENES_FILE = "scenes.json"

_DIGITS = 16


def keep_scenes(store: RunStore, episodes: Iterable[Episode]) -> None:
    """Remember the files of a run's scenes, or compare them with those that it began with.

    Args:
        store: Store of the run, open.
        episodes: All episodes of the run; scenes that are no files, such as houses, are left out.

    Raises:
        RunFolderError: A scene in which an episode is done has other files now.
        SceneError: A file cannot be read.
    """
    path = store.folder / SCENES_FILE
    known = _read(path)
    scenes = dict.fromkeys(episode.scene_id for episode in episodes)
    found = {scene: _digest(Path(scene)) for scene in scenes if Path(scene).is_file()}
    done = {record.scene_id for record in store.records.values()}
    both = done & known.keys() & found.keys()
    changed = sorted(scene for scene in both if known[scene] != found[scene])
    if changed:
        more = f" and {len(changed) - 1} more" if len(changed) > 1 else ""
        raise RunFolderError(
            f"{store.folder} was begun with other files of the scene {changed[0]}{more}: mesh, "
            "navmesh or annotation changed since episodes were done in it. Bring them back, or "
            "choose another --out"
        )
    if found != known:
        write_whole(path, json.dumps(known | found, indent=1) + "\n")


def _read(path: Path) -> dict[str, str]:
    try:
        content = parse_json(read_file(path))
    except FileNotFoundError:
        return {}
    except (OSError, ValueError) as error:
        raise RunFolderError(f"{path} cannot be read: {error}") from error
    if not isinstance(content, dict):
        raise RunFolderError(f"{path} holds no scenes; was it edited?")
    return content


def _digest(mesh: Path) -> str:
    """A hash of the content of a scene's files."""
    scan = ScanFiles.of(mesh)
    beside = (
        (mesh.with_name(OBJECTS_FILE),)
        if scan is None
        else (scan.semantic_mesh, scan.semantic_text, scan.navmesh)
    )
    whole = hashlib.sha256()
    for path in (mesh, *(path for path in beside if path is not None and path.is_file())):
        try:
            with path.open("rb") as file:
                whole.update(hashlib.file_digest(file, "sha256").digest())
        except OSError as error:
            raise SceneError(f"{path}: cannot be read ({error.strerror or error})") from error
    return whole.hexdigest()[:_DIGITS]
