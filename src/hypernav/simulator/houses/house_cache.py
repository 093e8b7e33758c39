"""Cache of buildings on disk, so that each is generated only once.

A building's file holds its triangles; the shared images of the texture library are beside it.
Everything is written to a temporary file first and then renamed, so that no reader ever sees an
incomplete file. A broken file is replaced; without a writable folder nothing is cached.
"""

import hashlib
import json
import logging
import zipfile
from dataclasses import asdict
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Int32

from hypernav.core.naming.labels import ObjectLabel
from hypernav.io.cache_folder import cache_folder
from hypernav.io.kept_arrays import keep
from hypernav.lab.datasets.shipped import check_geometry
from hypernav.simulator.houses.assembly import CompactScene, to_scene
from hypernav.simulator.houses.building import VERSION, Building
from hypernav.simulator.houses.modelling.model import Finish
from hypernav.simulator.houses.textures.library import is_image, is_loaded, store_texture, texture
from hypernav.simulator.worlds.scenes.scene import Scene

_ARRAYS = ("positions", "normals", "uv", "faces", "face_material", "face_instance")
_NOT_GENERATING = ("export", "episodes")
_BROKEN = (EOFError, ValueError, KeyError, TypeError, zipfile.BadZipFile)
_LOGGER = logging.getLogger(__name__)


@lru_cache(maxsize=1)
def generator_version() -> str:
    """Version of the generator together with a digest of its sources.

    The digest is for developers of the generator: without it, if they forgot to increase the
    version, outdated buildings would be used.
    """
    digest = hashlib.sha256()
    here = Path(__file__).parent
    for source in sorted(here.rglob("*.py")):
        if source.parent.name in _NOT_GENERATING:
            continue
        digest.update(source.relative_to(here).as_posix().encode())
        digest.update(source.read_bytes())
    return f"v{VERSION}-{digest.hexdigest()[:12]}"


def cached_building(building: Building, folder: Path | None = None) -> Scene:
    """Scene of a building, from the cache if possible; otherwise generated and cached.

    Args:
        building: The building.
        folder: Cache folder; `cache_folder()` if None.

    Raises:
        SceneError: It belongs to a split that is shipped, and is drawn differently here.
    """
    home = (folder or cache_folder()) / building.kind / generator_version()
    path = home / f"{building.number}.npz"
    try:
        stored = _read(path)
    except OSError as error:  # it is not there, or nothing can be: `cache_folder` has said so
        _LOGGER.debug("%s is not read (%s)", path, error)
        stored = None
    except _BROKEN as error:
        _LOGGER.warning("%s is broken (%s) and is built again", path, error)
        stored = None
    if stored is not None:
        _load_textures(stored, home / "textures")
        return to_scene(stored, building.scene)
    # Imported here, because a cached building does not need the generator.
    from hypernav.simulator.houses.generator import build_compact

    fresh = build_compact(building)
    _load_textures(fresh, home / "textures")
    scene = checked_scene(building, fresh, building.scene)
    keep(path, lambda file: _write(file, fresh))
    return scene


def checked_scene(building: Building, drawn: CompactScene, name: str) -> Scene:
    """A building that was just drawn, as a scene of this name.

    Raises:
        SceneError: It belongs to a split that is shipped, and is drawn differently here.
    """
    scene = to_scene(drawn, name)
    check_geometry(building.kind, building.number, geometry_digest(scene))
    return scene


def geometry_digest(scene: Scene) -> str:
    """Digest of what stands where: triangles, materials, and objects with their labels.

    Of numbers in whole millimetres and thousandths: the last bits of floats, which differ between
    processors, do not matter, and a chair that moved by a centimetre does.
    """
    sha = hashlib.sha256(in_thousandths(scene.vertices).tobytes())
    for array in (scene.faces, scene.face_material, scene.face_instance):
        sha.update(np.asarray(array, dtype="<i4").tobytes())
    sha.update(repr([(one.name, one.label) for one in scene.instances]).encode())
    looks = [(i.name, in_thousandths(i.color).tolist(), i.unlit) for i in scene.materials]
    sha.update(repr((looks, scene.storeys)).encode())
    return sha.hexdigest()[:16]


def in_thousandths(values: Any) -> Int32[np.ndarray, "..."]:
    """Numbers in whole thousandths.

    Generated numbers are rounded to tenths of those, so that an edge between two thousandths is as
    far from each as can be.
    """
    return np.floor(np.asarray(values, dtype=np.float64) * 1000.0 + 0.55).astype("<i4")


def _write(file: Path, house: CompactScene) -> None:
    about = {
        "finishes": [asdict(finish) for finish in house.finishes],
        "names": house.names,
        "categories": house.categories,
        "rooms": house.rooms,
        "labels": [None if label is None else asdict(label) for label in house.labels],
    }
    text = np.frombuffer(json.dumps(about).encode(), dtype=np.uint8)
    np.savez(file, about=text, **{name: getattr(house, name) for name in _ARRAYS})


def _read(path: Path) -> CompactScene:
    with path.open("rb") as file, np.load(file, allow_pickle=False) as stored:
        about = json.loads(stored["about"].tobytes())
        arrays = {name: stored[name] for name in _ARRAYS}
    finishes = tuple(Finish(**{**f, "color": tuple(f["color"])}) for f in about["finishes"])
    labels = tuple(None if label is None else _label(label) for label in about["labels"])
    return CompactScene(
        **arrays,
        finishes=finishes,
        names=tuple(about["names"]),
        categories=tuple(about["categories"]),
        rooms=tuple(about["rooms"]),
        labels=labels,
    )


def _label(stored: dict[str, Any]) -> ObjectLabel:
    return ObjectLabel(
        stored["category"],
        tuple(stored["synonyms"]),
        tuple(stored["attributes"]),
        stored["room"],
        tuple(stored["beside"]),
    )


def _load_textures(house: CompactScene, folder: Path) -> None:
    """Load the textures of a building into the library, from files where there are any."""
    for key in dict.fromkeys(f.texture for f in house.finishes if f.texture):
        path = folder / f"{key.replace(' ', '_')}.npy"
        try:
            if is_loaded(key) and path.exists():
                continue
            with path.open("rb") as file:
                image = np.load(file, allow_pickle=False)
            if is_image(image) and not is_loaded(key):
                store_texture(key, image)
                continue
        except OSError as error:
            _LOGGER.debug("%s is not read (%s)", path, error)
        except _BROKEN as error:
            _LOGGER.warning("%s is broken (%s) and is made again", path, error)
        image = texture(key)
        keep(path, lambda file, image=image: np.save(file, image))
