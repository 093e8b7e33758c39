"""Cache of scans on disk: triangles, instances and decoded textures, so that they open quickly.

A folder holds one scan, and data computed from it by other modules (`Scene.cache`). Textures are
mapped into memory and read when they are needed. A broken folder is written again; without a
writable cache nothing is kept.
"""

import hashlib
import json
import logging
import zipfile
from collections.abc import Callable
from dataclasses import asdict, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from hypernav.core.labels import ObjectLabel
from hypernav.core.world import Instance
from hypernav.io.cache_folder import cache_folder
from hypernav.io.kept_arrays import digest_of, keep, mapped_array
from hypernav.worlds.scans.layout import ScanFiles
from hypernav.worlds.scenes.scene import Material, Scene, Wrap

LEAST_BYTES = 10_000_000
"""Smaller meshes are read as fast without a cache."""

_ARRAYS = ("vertices", "faces", "uv", "colors", "face_material", "face_instance")
_IMAGES = ("texture", "opaque")
_BROKEN = (EOFError, ValueError, KeyError, TypeError, IndexError, zipfile.BadZipFile)
_LOGGER = logging.getLogger(__name__)


def cached_scan(
    files: ScanFiles,
    load: Callable[[ScanFiles], Scene],
    *,
    folder: Path | None = None,
    least_bytes: int = LEAST_BYTES,
) -> Scene:
    """A scan from the cache; if it is not there, it is loaded and kept.

    Args:
        files: Files of the scan; if one of them changes, the scan is loaded again.
        load: Function that loads it.
        folder: Cache folder; `cache_folder()` if None.
        least_bytes: Size of the smallest mesh that is kept, bytes.
    """
    if files.mesh.stat().st_size < least_bytes:
        return load(files)
    home = (folder or cache_folder()) / "scans" / _key(files)
    try:
        return _read(home, files)
    except OSError as error:  # it is not there, or nothing can be: `cache_folder` has said so
        _LOGGER.debug("%s is not read (%s)", home, error)
    except _BROKEN as error:
        _LOGGER.warning("%s is broken (%s) and is written again", home, error)
    scene = load(files)
    keep(home, lambda fresh: _write(fresh, scene))
    return replace(scene, cache=home) if home.is_dir() else scene


def _key(files: ScanFiles) -> str:
    """A name that changes with the files and with the code that reads them."""
    digest = hashlib.sha256(_reader_version().encode())
    for path in (files.mesh, files.semantic_mesh, files.semantic_text):
        if path is not None:
            status = path.stat()
            told = (str(path.resolve()), status.st_size, status.st_mtime_ns)
            digest.update(json.dumps(told).encode())
    return f"{files.mesh.stem}-{digest.hexdigest()[:16]}"


@lru_cache(maxsize=1)
def _reader_version() -> str:
    here = Path(__file__).parents[1]
    return digest_of(source for room in ("scans", "scenes") for source in _sources(here / room))


def _sources(folder: Path) -> list[Path]:
    return sorted(folder.glob("*.py"))


def _read(home: Path, files: ScanFiles) -> Scene:
    with (home / "scan.npz").open("rb") as file, np.load(file, allow_pickle=False) as stored:
        about = json.loads(stored["about"].tobytes())
        arrays = {name: stored[name] for name in _ARRAYS}
    images = [mapped_array(home / f"{number}.npy") for number in range(about["images"])]
    return Scene(
        name=about["name"],
        **arrays,
        normals=None,
        materials=tuple(_material(one, images) for one in about["materials"]),
        instances=tuple(_instance(one) for one in about["instances"]),
        unlit=True,
        navmesh=files.navmesh,
        stored_z_up=True,
        cache=home,
    )


def _material(stored: dict[str, Any], images: list[Any]) -> Material:
    texture, opaque = (None if stored[k] is None else images[stored[k]] for k in _IMAGES)
    return Material(
        stored["name"],
        tuple(stored["color"]),
        texture,
        (Wrap(stored["wrap"][0]), Wrap(stored["wrap"][1])),
        opaque,
        stored["unlit"],
    )


def _instance(stored: dict[str, Any]) -> Instance:
    label = None
    if stored["label"] is not None:
        category, synonyms = stored["label"]
        label = ObjectLabel(category, tuple(synonyms))
    low, high = tuple(stored["box_min"]), tuple(stored["box_max"])
    return Instance(stored["id"], stored["name"], label, low, high)


def _write(home: Path, scene: Scene) -> None:
    images: dict[int, int] = {}
    materials = []
    for material in scene.materials:
        about: dict[str, Any] = {"texture": None, "opaque": None}
        for kind in _IMAGES:
            image = getattr(material, kind)
            if image is not None:
                if id(image) not in images:
                    images[id(image)] = len(images)
                    np.save(home / f"{images[id(image)]}.npy", image)
                about[kind] = images[id(image)]
        about |= {"name": material.name, "color": material.color, "unlit": material.unlit}
        materials.append(about | {"wrap": [int(way) for way in material.wrap]})
    instances = [
        asdict(one)
        | {"label": None if one.label is None else (one.label.category, one.label.synonyms)}
        for one in scene.instances
    ]
    about = {
        "name": scene.name,
        "materials": materials,
        "instances": instances,
        "images": len(images),
    }
    text = np.frombuffer(json.dumps(about).encode(), dtype=np.uint8)
    arrays = {name: getattr(scene, name) for name in _ARRAYS}
    np.savez(home / "scan.npz", about=text, **arrays)
