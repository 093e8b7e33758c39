"""Scenes out of boxes, built by hand for tests."""

import colorsys
import zlib
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import trimesh
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.world import Instance
from hypernav.simulator.worlds.scenes.scene import Material, Scene

_FACES = np.array(
    [
        [0, 2, 1], [0, 3, 2], [4, 5, 6], [4, 6, 7], [0, 1, 5], [0, 5, 4],
        [1, 2, 6], [1, 6, 5], [2, 3, 7], [2, 7, 6], [3, 0, 4], [3, 4, 7],
    ]
)  # fmt: skip
_CORNERS = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
)

Box = tuple[str | None, Sequence[float], Sequence[float]]


def scene_of(*boxes: Box, name: str = "boxes") -> Scene:
    """Boxes ``(category or None, lowest corner, highest corner)``; instance k is the k-th."""
    vertices, faces, owner, instances = [], [], [], []
    for k, (category, low, high) in enumerate(boxes):
        corners = np.array(low) + _CORNERS * (np.array(high) - np.array(low))
        faces.append(_FACES + 8 * k)
        vertices.append(corners)
        owner.append(np.full(12, k))
        label = None if category is None else ObjectLabel(category)
        instances.append(
            Instance(
                k,
                f"{category or 'structure'}_{k}",
                label,
                (float(low[0]), float(low[1]), float(low[2])),
                (float(high[0]), float(high[1]), float(high[2])),
            )
        )
    n = 12 * len(boxes)
    return Scene(
        name=name,
        vertices=np.concatenate(vertices).astype(np.float32),
        faces=np.concatenate(faces).astype(np.int32),
        uv=np.zeros((n, 3, 2), np.float32),
        colors=np.full((n, 3, 3), 200, np.uint8),
        normals=None,
        face_material=np.zeros(n, np.int32),
        face_instance=np.concatenate(owner).astype(np.int32),
        materials=(Material("plain", (1.0, 1.0, 1.0)),),
        instances=tuple(instances),
    )


def room_boxes(width: float = 6.0, depth: float = 4.0, *, ceiling: bool = True) -> list[Box]:
    """A floor from (0, 0) to (width, depth) with walls around it, 2.5 m high, and a ceiling."""
    boxes: list[Box] = [
        (None, (-0.1, -0.1, -0.1), (width + 0.1, depth + 0.1, 0.0)),
        (None, (-0.1, -0.1, 0.0), (width + 0.1, 0.0, 2.5)),
        (None, (-0.1, depth, 0.0), (width + 0.1, depth + 0.1, 2.5)),
        (None, (-0.1, 0.0, 0.0), (0.0, depth, 2.5)),
        (None, (width, 0.0, 0.0), (width + 0.1, depth, 2.5)),
    ]
    if ceiling:
        boxes.append((None, (-0.1, -0.1, 2.5), (width + 0.1, depth + 0.1, 2.6)))
    return boxes


def room_glb(path: Path) -> Path:
    """A room of 6 m by 4 m with a bed as a GLB whose nodes carry the names."""
    return boxes_glb(path, [*room_boxes(6.0, 4.0), ("bed", (4.0, 0.1, 0.0), (5.9, 1.7, 0.5))])


def boxes_glb(path: Path, boxes: Sequence[Box]) -> Path:
    """Boxes as a GLB whose nodes carry the names; every category has a colour of its own."""
    scene = trimesh.Scene()
    to_gltf = [[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]]
    for number, (name, low, high) in enumerate(boxes):
        mesh = trimesh.creation.box(bounds=[low, high])
        mesh.apply_transform(to_gltf)
        if name is not None:
            color = colorsys.hls_to_rgb(zlib.crc32(name.encode()) % 360 / 360.0, 0.5, 0.4)
            material = PBRMaterial(baseColorFactor=[*color, 1.0])
            mesh.visual = TextureVisuals(material=material)
        scene.add_geometry(mesh, node_name=f"{name or 'wall'}_{number:02d}")
    scene.export(path)
    return path
