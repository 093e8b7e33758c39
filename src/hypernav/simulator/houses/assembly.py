"""Names, labels and assembles placed models into a scene, through a compact form for files.

Every number is quantised (positions to a tenth of a millimetre), so that the last bits of sines and
sums, which differ between machines, do not affect the scene.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Int16, Int32, UInt16

from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.world import Instance
from hypernav.simulator.houses.modelling.model import Finish, Model, rotation_matrix
from hypernav.simulator.houses.textures.library import texture
from hypernav.simulator.worlds.scenes.scene import Material, Scene, Wrap

_STEPS_PER_M = 10_000
_NORMAL_STEPS = 32_000
_UV_STEPS = 8_192
# Rounding of values that are in theory exactly half a step must not depend on the last bit.
_TIE_OFFSET = 0.0137

_NEAR_M = 0.45
_FLAT = ("rug", "doormat", "bath mat", "ceiling lamp", "chandelier", "curtain", "window", "door")


@dataclass(frozen=True, eq=False)
class PlacedModel:
    """A model at its position in the house.

    Attributes:
        model: The model.
        x: Centre of its footprint, metres, scene frame.
        y: Centre of its footprint, metres, scene frame.
        z: Height of the model's z = 0, metres.
        yaw_deg: Counter-clockwise rotation of its front from +y, degrees.
        room: Name of its room; empty for parts of the building.
        structural: Whether it is a wall, floor or ceiling, which is never a goal.
    """

    model: Model
    x: float
    y: float
    z: float = 0.0
    yaw_deg: float = 0.0
    room: str = ""
    structural: bool = False


@dataclass(frozen=True, eq=False)
class CompactScene:
    """Everything that a house consists of except the pixels of its textures.

    Attributes:
        positions: Vertex positions, tenths of a millimetre, scene frame.
        normals: Unit normals of the vertices, times 32,000.
        uv: Texture coordinates of the vertices.
        faces: Indices of the vertices of every triangle.
        face_material: Index in ``finishes`` of every triangle.
        face_instance: Index in ``names`` of every triangle.
        finishes: All materials.
        names: Names of the instances.
        categories: Categories of the instances, parts of the building included.
        rooms: Names of the instances' rooms; empty for an instance outside of all rooms.
        labels: Labels of the instances; None for parts of the building.
    """

    positions: Int32[np.ndarray, "vertices 3"]
    normals: Int16[np.ndarray, "vertices 3"]
    uv: Float32[np.ndarray, "vertices 2"]
    faces: Int32[np.ndarray, "faces 3"]
    face_material: UInt16[np.ndarray, "faces"]
    face_instance: UInt16[np.ndarray, "faces"]
    finishes: tuple[Finish, ...]
    names: tuple[str, ...]
    categories: tuple[str, ...]
    rooms: tuple[str, ...]
    labels: tuple[ObjectLabel | None, ...]


def quantised(values: np.ndarray, steps: int) -> np.ndarray:
    """Values in whole steps, rounded (any shape)."""
    return np.floor(values * steps + (0.5 + _TIE_OFFSET))


def compact(
    pieces: Sequence[PlacedModel], names: Sequence[str], labels: Sequence[ObjectLabel | None]
) -> CompactScene:
    """Triangles of all pieces, in their order.

    Args:
        pieces: All models of the house.
        names: One unique name per piece.
        labels: One label per piece.
    """
    finishes: dict[Finish, int] = {}
    positions, normals, uv, faces, materials, instances = [], [], [], [], [], []
    start = 0
    for number, piece in enumerate(pieces):
        rotation = rotation_matrix(piece.yaw_deg)
        for part in piece.model.parts:
            mesh, finish = part.mesh, part.finish
            material = finishes.setdefault(finish, len(finishes))
            c, s = rotation[0, 0], rotation[1, 0]
            p, n = mesh.positions, mesh.normals
            moved, turned = np.empty_like(p), np.empty_like(n)
            moved[:, 0] = p[:, 0] * c - p[:, 1] * s + piece.x
            moved[:, 1] = p[:, 0] * s + p[:, 1] * c + piece.y
            moved[:, 2] = p[:, 2] + piece.z
            turned[:, 0], turned[:, 1] = n[:, 0] * c - n[:, 1] * s, n[:, 0] * s + n[:, 1] * c
            turned[:, 2] = n[:, 2]
            positions.append(moved)
            normals.append(turned)
            uv.append(mesh.uv / finish.tile_m)
            faces.append(mesh.faces + start)
            materials.append(np.full(len(mesh.faces), material, dtype=np.uint16))
            instances.append(np.full(len(mesh.faces), number, dtype=np.uint16))
            start += len(p)
    return CompactScene(
        quantised(np.concatenate(positions), _STEPS_PER_M).astype(np.int32),
        quantised(np.concatenate(normals), _NORMAL_STEPS).astype(np.int16),
        (quantised(np.concatenate(uv), _UV_STEPS) / _UV_STEPS).astype(np.float32),
        np.concatenate(faces).astype(np.int32),
        np.concatenate(materials),
        np.concatenate(instances),
        tuple(finishes),
        tuple(names),
        tuple(piece.model.category for piece in pieces),
        tuple(piece.room for piece in pieces),
        tuple(labels),
    )


def to_scene(house: CompactScene, name: str) -> Scene:
    """Scene of a compact house."""
    vertices = (house.positions / np.float64(_STEPS_PER_M)).astype(np.float32)
    normals = house.normals.astype(np.float32) / np.float32(_NORMAL_STEPS)
    corners = house.faces.ravel()
    return Scene(
        name=name,
        vertices=vertices,
        faces=house.faces,
        uv=house.uv[corners].reshape(-1, 3, 2),
        colors=np.full((len(house.faces), 3, 3), 255, dtype=np.uint8),
        normals=normals[corners].reshape(-1, 3, 3),
        face_material=house.face_material.astype(np.int32),
        face_instance=house.face_instance.astype(np.int32),
        materials=tuple(_material(number, f) for number, f in enumerate(house.finishes)),
        instances=(instances := _instances(house, vertices)),
        storeys=_storeys(house, instances),
    )


def _storeys(house: CompactScene, instances: Sequence[Instance]) -> tuple[float, ...]:
    """Heights of the floors if they differ, as `Scene` holds them."""
    floors = {
        round(one.box_min[2], 2)
        for one, category in zip(instances, house.categories, strict=True)
        if one.label is None and category == "floor"
    }
    return tuple(sorted(floors)) if len(floors) > 1 else ()


def _material(number: int, finish: Finish) -> Material:
    words = " ".join(w for w in (finish.hue, finish.material, finish.texture) if w)
    fitted = finish.texture != "" and finish.tile_m == 1.0 and finish.hue == ""
    wrap = Wrap.CLAMP if fitted else Wrap.REPEAT
    return Material(
        name=f"{number:03d} {words}".strip(),
        color=finish.color,
        texture=texture(finish.texture) if finish.texture else None,
        wrap=(wrap, wrap),
        unlit=finish.unlit,
    )


def _instances(
    house: CompactScene, vertices: Float32[np.ndarray, "vertices 3"]
) -> tuple[Instance, ...]:
    # Faces and vertices are ordered by instance, so boxes are reductions over runs.
    first_face = np.searchsorted(house.face_instance, np.arange(len(house.names)))
    lowest = np.minimum.reduceat(house.faces.min(axis=1), first_face)
    low = np.minimum.reduceat(vertices, lowest, axis=0)
    high = np.maximum.reduceat(vertices, lowest, axis=0)
    return tuple(
        Instance(k, name, label, _triple(low[k]), _triple(high[k]))
        for k, (name, label) in enumerate(zip(house.names, house.labels, strict=True))
    )


def _triple(values: Float32[np.ndarray, "3"]) -> tuple[float, float, float]:
    return (float(values[0]), float(values[1]), float(values[2]))


def name_and_label(pieces: Sequence[PlacedModel]) -> tuple[list[str], list[ObjectLabel | None]]:
    """Unique name of every piece, and its label if it can be a goal."""
    seen: dict[str, int] = {}
    names = []
    for piece in pieces:
        word = f"{piece.model.category} {piece.room}" if piece.structural else piece.model.category
        key = word.strip().replace(" ", "_")
        seen[key] = seen.get(key, 0) + 1
        names.append(f"{key}_{seen[key]}")
    boxes = np.array([bounding_box(p) for p in pieces])
    labels = [_label(k, pieces, boxes) for k in range(len(pieces))]
    return names, labels


def bounding_box(piece: PlacedModel) -> tuple[float, float, float, float, float, float]:
    """Axis-aligned bounding box in the scene: its lowest and highest corner, metres."""
    m = piece.model
    r = rotation_matrix(piece.yaw_deg)
    corners = [
        (x * r[0, 0] + y * r[0, 1], x * r[1, 0] + y * r[1, 1])
        for x in (m.low[0], m.high[0])
        for y in (m.low[1], m.high[1])
    ]
    xs, ys = [float(c[0]) + piece.x for c in corners], [float(c[1]) + piece.y for c in corners]
    return (min(xs), min(ys), piece.z + m.low[2], max(xs), max(ys), piece.z + m.high[2])


def _label(number: int, pieces: Sequence[PlacedModel], boxes: np.ndarray) -> ObjectLabel | None:
    piece = pieces[number]
    if piece.structural and piece.model.category != "window":
        return None
    model = piece.model
    attributes = tuple(dict.fromkeys(a for a in model.attributes if a))
    return ObjectLabel(
        model.category,
        tuple(s for s in model.synonyms if s != model.category),
        attributes,
        room_kind(piece.room),
        _beside(number, pieces, boxes),
    )


def room_kind(name: str) -> str:
    """Kind of a room by its name: "bedroom 2" is a "bedroom"."""
    head, _, tail = name.rpartition(" ")
    return head if tail.isdigit() else name


def _beside(number: int, pieces: Sequence[PlacedModel], boxes: np.ndarray) -> tuple[str, ...]:
    """Categories of the objects within 0.45 m, nearest first."""
    own = boxes[number]
    gap = np.maximum(np.maximum(boxes[:, :3] - own[3:], own[:3] - boxes[:, 3:]), 0.0)
    distance = np.sqrt((gap * gap).sum(axis=1))
    near = [k for k in np.argsort(distance, kind="stable") if distance[k] < _NEAR_M and k != number]
    kinds = [
        pieces[k].model.category
        for k in near
        if pieces[k].room == pieces[number].room
        and not pieces[k].structural
        and pieces[k].model.category not in _FLAT
    ]
    return tuple(dict.fromkeys(kinds))[:8]
