"""Reads IFC files (ISO 16739-1), the exchange format of building models, with ifcopenshell.

Its geometry is made in metres, whatever the file's unit, and z up.
"""

import logging
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float64

from hypernav.core.components.registry import require
from hypernav.core.errors import MissingExtraError, SceneError
from hypernav.simulator.worlds.scenes.mesh_parts import MeshPart
from hypernav.simulator.worlds.scenes.node_names import unique_name
from hypernav.simulator.worlds.scenes.scene import Material

_NOT_SOLID = ["IfcSpace", "IfcOpeningElement", "IfcAnnotation", "IfcGrid", "IfcVirtualElement"]
_FAR_M = 1000.0
"""Beyond this, as with coordinates of a map, single precision loses millimetres."""
_PLAIN = (0.8, 0.8, 0.8)
_LOGGER = logging.getLogger(__name__)


def read_ifc(path: Path) -> tuple[list[MeshPart], list[Material]]:
    """All solid products of a file, in the scene frame, and their colours.

    Each is a node called by its class and name, ``IfcFurniture/Bed``. A building at coordinates of
    a map is moved to the origin, with a warning that says by how much.

    Args:
        path: An ``.ifc`` file.

    Raises:
        SceneError: It can't be read.
        MissingExtraError: ifcopenshell is not installed.
    """
    try:
        ifcopenshell: Any = require("ifcopenshell", extra="ifc")
        geometry: Any = require("ifcopenshell.geom", extra="ifc")
    except MissingExtraError as error:
        glb = path.with_suffix(".glb")
        raise MissingExtraError(
            f"{path}: {error}; or convert it yourself: IfcConvert --use-element-names {path} {glb}"
        ) from error
    try:
        model = ifcopenshell.open(str(path))
        shapes = list(_shapes(geometry, model))
    except (ifcopenshell.Error, RuntimeError) as error:
        raise SceneError(
            f"{path}: cannot be read as IFC ({' '.join(str(error).split())}); export it again"
        ) from error
    shift = _shift([vertices for _, vertices, _ in shapes])
    if shift.any():
        moved = ", ".join(f"{-value:.0f}" for value in shift)
        _LOGGER.warning("%s: is moved by (%s) m, to the origin", path, moved)
    parts: list[MeshPart] = []
    materials: list[Material] = []
    taken: dict[str, int] = {}
    for name, vertices, mesh in shapes:
        node = unique_name(name, taken)
        faces = np.array(mesh.faces, np.int32).reshape(-1, 3)
        paint = np.array(mesh.material_ids, np.int64)
        placed = (vertices - shift).astype(np.float32)
        for number in np.unique(paint).tolist():
            parts.append(MeshPart(node, name, placed, faces[paint == number], len(materials)))
            color = _color(mesh.materials[number]) if number >= 0 else _PLAIN
            materials.append(Material(name, color))
    return parts, materials


def _shapes(geometry: Any, model: Any) -> Iterator[tuple[str, Float64[np.ndarray, "n 3"], Any]]:
    """Name, vertices in metres and mesh of every product that has triangles."""
    settings = geometry.settings()
    settings.set("use-world-coords", True)
    shapes = geometry.iterator(settings, model, exclude=_NOT_SOLID)
    more = shapes.initialize()
    while more:
        shape = shapes.get()
        mesh = shape.geometry
        if len(mesh.faces):
            vertices = np.array(mesh.verts, np.float64).reshape(-1, 3)
            yield f"{shape.type}/{shape.name or shape.guid}", vertices, mesh
        more = shapes.next()


def _shift(vertices: list[Float64[np.ndarray, "n 3"]]) -> Float64[np.ndarray, "3"]:
    """Whole metres from the origin to the middle of a building that is far away from it."""
    if not vertices:
        return np.zeros(3)
    middle = np.median(np.concatenate(vertices), axis=0)
    return np.where(np.abs(middle) > _FAR_M, np.round(middle), 0.0)


def _color(style: Any) -> tuple[float, float, float]:
    """SRGB colour of a style; IFC's colours are those of screens."""
    red, green, blue = style.diffuse.components
    known = all(math.isfinite(value) and 0.0 <= value <= 1.0 for value in (red, green, blue))
    return (float(red), float(green), float(blue)) if known else _PLAIN
