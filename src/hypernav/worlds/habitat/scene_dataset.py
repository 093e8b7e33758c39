"""The scene-dataset configuration by which habitat-sim opens a scene.

It says how the scene stands and where its annotation lies. habitat-sim takes a GLB without one for
one of Matterport's, z up, so a scene of any other kind gets one here, for as long as it is opened
(attributes of stages; its own documentation, "Using JSON Files to configure Attributes").
"""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from hypernav.worlds.scenes.scene import Scene

_NAMES = (
    "hm3d_annotated_basis.scene_dataset_config.json",
    "hm3d_basis.scene_dataset_config.json",
    "mp3d.scene_dataset_config.json",
    "hypernav.scene_dataset_config.json",
)
_FOLDERS_ABOVE = 4


@contextmanager
def scene_dataset(scene: Scene, mesh: Path) -> Iterator[Path | None]:
    """The configuration of a scene; None where habitat-sim's own assumptions hold.

    Args:
        scene: The scene as we read it.
        mesh: File of the scene.
    """
    found = _above(mesh)
    if found is not None or scene.stored_z_up:
        yield found
        return
    with TemporaryDirectory() as folder:
        path = Path(folder) / "upright.scene_dataset_config.json"
        path.write_text(json.dumps(_upright(mesh)))
        yield path


def _above(mesh: Path) -> Path | None:
    """The configuration of a data set in a folder above a scene, which brings its annotation."""
    for folder in list(mesh.resolve().parents)[:_FOLDERS_ABOVE]:
        for name in _NAMES:
            if (folder / name).is_file():
                return folder / name
    return None


def _upright(mesh: Path) -> dict[str, object]:
    """Attributes of a scene that is y up, as glTF prescribes."""
    attributes = {"shader_type": "flat", "up": [0, 1, 0], "front": [0, 0, -1], "origin": [0, 0, 0]}
    stages = {"default_attributes": attributes, "paths": {".glb": [str(mesh.resolve())]}}
    return {"stages": stages}
