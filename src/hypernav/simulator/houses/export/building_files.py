"""Export of a building as files for this package, Habitat, Blender and web viewers.

habitat-sim assumes that any GLB is one of Matterport's, z up; only the scene-dataset configuration
tells it that ours are y up, and where their semantics and navigation meshes are (attributes of
stages; its own documentation, "Using JSON Files to configure Attributes").
"""

import colorsys
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import UInt8

from hypernav.core.embodiment import BodyConfig
from hypernav.core.errors import SceneError
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.world import Instance
from hypernav.simulator.houses.assembly import CompactScene
from hypernav.simulator.houses.building import Building
from hypernav.simulator.houses.export.glb import with_backs, write_house, write_semantics
from hypernav.simulator.houses.generator import build_compact, storeys_of
from hypernav.simulator.houses.house_cache import checked_scene
from hypernav.simulator.worlds.navmesh.grid_mesh import mesh_from_grid
from hypernav.simulator.worlds.navmesh.navmesh_writer import navmesh_bytes
from hypernav.simulator.worlds.navmesh.robot_navmesh import computed_for
from hypernav.simulator.worlds.scenes.loading import OBJECTS_FILE
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.surface.walkable import WalkableGrid

FIRST_ANNOTATION = 1
"""Number of the first instance in the semantics, where 0 means nothing."""

HABITAT_ROBOT = BodyConfig(height_m=0.88)
"""The default robot in Habitat's configuration; Recast rounds this height to 1.0 m."""

DATASET_CONFIG = "hypernav.scene_dataset_config.json"
"""Name of the file."""

_OWN_NAME = "%%CONFIG_NAME_AS_ASSET_FILENAME%%"
"""Placeholder that habitat-sim replaces by the name of a stage's file without suffix."""


@dataclass(frozen=True)
class ExportedBuilding:
    """Paths of the files of an exported building.

    Attributes:
        glb: Building as binary glTF (y up).
        objects: Metadata of its nodes.
        semantic_glb: Building in colours that identify its instances.
        semantic_txt: Instance of every colour.
        navmesh: Navigation mesh for Habitat.
    """

    glb: Path
    objects: Path
    semantic_glb: Path
    semantic_txt: Path
    navmesh: Path


def export_building(building: Building, out_dir: Path) -> ExportedBuilding:
    """Write a building to a folder.

    ``house_N.glb`` and ``objects.json`` open with `hypernav.load_scene`; the rest is for
    Habitat: the semantics in the form of HM3D's (``house_N.semantic.glb`` with vertex colours,
    ``house_N.semantic.txt``), and the walkable surface of the default robot, ``house_N.navmesh``.
    `hypernav.simulator.houses.export.building_files` tells it about them.

    Args:
        building: The building.
        out_dir: Folder to write to; created if missing.

    Raises:
        SceneError: The folder cannot be written; or the building belongs to a split that is
            shipped, and is drawn differently here.
    """
    name = building.file_stem
    files = ExportedBuilding(
        out_dir / f"{name}.glb",
        out_dir / OBJECTS_FILE,
        out_dir / f"{name}.semantic.glb",
        out_dir / f"{name}.semantic.txt",
        out_dir / f"{name}.navmesh",
    )
    try:
        house = build_compact(building)
        scene = checked_scene(building, house, name)
        out_dir.mkdir(parents=True, exist_ok=True)
        rooms = [room.name for plan in storeys_of(building) for room in plan.rooms]
        seen = with_backs(house)
        write_house(seen, files.glb)
        files.objects.write_text(json.dumps(_objects(scene, seen), indent=1) + "\n")
        colors = _colors(len(house.names))
        write_semantics(seen, colors, files.semantic_glb)
        files.semantic_txt.write_text(_semantic_lines(house, colors, rooms))
        files.navmesh.write_bytes(_navmesh(scene))
    except OSError as error:
        raise SceneError(f"{out_dir}: cannot be written ({error.strerror or error})") from error
    return files


def _navmesh(scene: Scene) -> bytes:
    """The default robot's mesh; over stairs, that of Habitat's robot, which climbs them."""
    if scene.storeys:
        return computed_for(scene, HABITAT_ROBOT)
    walkable = WalkableGrid.from_scene(scene, BodyConfig())
    return navmesh_bytes(mesh_from_grid(walkable), HABITAT_ROBOT)


def _objects(scene: Scene, house: CompactScene) -> dict[str, Any]:
    triangles = np.bincount(house.face_instance, minlength=len(house.names))
    storeys = {"storeys": list(scene.storeys)} if scene.storeys else {}
    return {
        "frame": "GLB is glTF y-up metres (x,y,z)_gltf=(x,z,-y)_zup; zup is the scene's own frame",
        "objects": [
            _object(instance, int(triangles[instance.id]), house.categories[instance.id])
            for instance in scene.instances
        ],
        **storeys,
    }


def _object(instance: Instance, triangles: int, category: str) -> dict[str, Any]:
    low, high = instance.box_min, instance.box_max
    label = instance.label
    return {
        "id": instance.id,
        "name": instance.name,
        "category": category,
        "structural": label is None,
        "triangles": triangles,
        "nodes": [instance.name],
        "aabb_zup": [list(low), list(high)],
        "aabb_gltf": [[low[0], low[2], -high[1]], [high[0], high[2], -low[1]]],
        "synonyms": list(label.synonyms) if label else [],
        "attributes": list(label.attributes) if label else [],
        "room": label.room if label else "",
        "beside": list(label.beside) if label else [],
        "description": describe(label) if label else "",
    }


def _colors(count: int) -> UInt8[np.ndarray, "instances 3"]:
    """Unique and distinct colours, one per instance."""
    colors, seen = [], {(0, 0, 0)}
    step = 0
    while len(colors) < count:
        hue, ring = (step * 0.618034) % 1.0, step % 5
        rgb = colorsys.hsv_to_rgb(hue, 0.45 + 0.13 * ring, 0.98 - 0.11 * (step % 4))
        code = (round(rgb[0] * 255), round(rgb[1] * 255), round(rgb[2] * 255))
        step += 1
        if code not in seen:
            seen.add(code)
            colors.append(code)
    return np.array(colors, dtype=np.uint8)


def _semantic_lines(
    house: CompactScene, colors: UInt8[np.ndarray, "instances 3"], rooms: list[str]
) -> str:
    """Lines of HM3D's semantic file: instance, colour, category, room."""
    lines = ["HM3D Semantic Annotations"]
    for number, (name, category) in enumerate(zip(house.rooms, house.categories, strict=True)):
        hex_code = "".join(f"{c:02X}" for c in colors[number])
        room = rooms.index(name) if name in rooms else len(rooms)
        lines.append(f'{number + FIRST_ANNOTATION},{hex_code},"{category}",{room}')
    return "\n".join(lines) + "\n"


def write_dataset_config(folder: Path) -> Path:
    """Write the configuration of all exported buildings in a folder, or in folders of their own.

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


def describe(label: ObjectLabel) -> str:
    """Phrase with all that is known about an object, which is a goal that it satisfies.

    For example "teal fabric L-shaped sofa beside the coffee table in the living room".
    """
    words = [*label.attributes, label.category]
    other = next((o for o in label.beside if not label.is_named(o)), None)
    if other is not None:
        words.append(f"beside the {other}")
    if label.room:
        words.append(f"in the {label.room}")
    return " ".join(words)
