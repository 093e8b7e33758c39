"""Writes the scene-dataset configuration of exported buildings for habitat-sim.

habitat-sim assumes that any GLB is one of Matterport's, z up; only this file tells it that ours are
y up, and where their semantics and navigation meshes are (attributes of stages; its own
documentation, "Using JSON Files to configure Attributes").
"""

import json
from pathlib import Path
from typing import Any

from hypernav.core.errors import SceneError

DATASET_CONFIG = "hypernav.scene_dataset_config.json"
"""Name of the file."""

_OWN_NAME = "%%CONFIG_NAME_AS_ASSET_FILENAME%%"
"""Placeholder that habitat-sim replaces by the name of a stage's file without suffix."""


def write_dataset_config(folder: Path) -> Path:
    """Write the configuration of all exported buildings in a folder, or in folders of their own.

    Args:
        folder: Folder that the configuration lies in.

    Returns:
        Path of the file.

    Raises:
        SceneError: It cannot be written.
    """
    path = folder / DATASET_CONFIG
    stages = [glb for glb in folder.rglob("*.glb") if glb.with_suffix(".navmesh").is_file()]
    names = sorted(stage.relative_to(folder).as_posix() for stage in stages)
    try:
        path.write_text(json.dumps(_configuration(names), indent=2) + "\n")
    except OSError as error:
        raise SceneError(f"{path}: cannot be written ({error.strerror or error})") from error
    return path


def _configuration(stages: list[str]) -> dict[str, Any]:
    return {
        "stages": {
            "default_attributes": {
                "shader_type": "flat",
                "up": [0, 1, 0],
                "front": [0, 0, -1],
                "origin": [0, 0, 0],
                "semantic_up": [0, 1, 0],
                "semantic_front": [0, 0, -1],
                "semantic_asset": f"{_OWN_NAME}.semantic.glb",
                "semantic_descriptor_filename": f"{_OWN_NAME}.semantic.txt",
                "has_semantic_textures": False,
                "nav_asset": f"{_OWN_NAME}.navmesh",
            },
            "paths": {".glb": stages},
        },
        "scene_instances": {
            "default_attributes": {"default_lighting": "no_lights"},
            "paths": {".json": []},
        },
    }
