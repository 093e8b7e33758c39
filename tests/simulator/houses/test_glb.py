"""Leaves and other open surfaces are seen from both sides in Habitat, too."""

from dataclasses import replace

import numpy as np

from hypernav.simulator.houses.assembly import CompactScene
from hypernav.simulator.houses.building import BUILTIN_HOUSE, house
from hypernav.simulator.houses.export.glb import with_backs
from hypernav.simulator.houses.generator import build_compact

_SQUARE = [[0, 1, 2], [0, 2, 3]]
_CUBE = [
    [a, b, c]
    for p, q, r, s in (
        *((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1)),
        *((2, 3, 7, 6), (1, 5, 7, 3), (0, 2, 6, 4)),
    )
    for a, b, c in ((p, q, r), (p, r, s))
]


def scene_of(positions: np.ndarray, faces: list[list[int]], instances: list[int]) -> CompactScene:
    """A house of nothing but these faces."""
    return replace(
        build_compact(house(BUILTIN_HOUSE)),
        positions=positions.astype(np.int32),
        normals=np.zeros((len(positions), 3), dtype=np.int16),
        uv=np.zeros((len(positions), 2), dtype=np.float32),
        faces=np.array(faces, dtype=np.int32),
        face_instance=np.array(instances, dtype=np.uint16),
        face_material=np.array(instances, dtype=np.uint16),
    )


def test_a_sheet_gets_a_back_and_a_closed_body_none() -> None:
    cube = np.array([[i & 1, i >> 1 & 1, i >> 2] for i in range(8)]) * 100
    sheet = np.array([[0, 0, 0], [100, 0, 0], [100, 100, 0], [0, 100, 0]])
    faces = _CUBE + [[8 + k for k in face] for face in _SQUARE]
    seen = with_backs(scene_of(np.concatenate([cube, sheet]), faces, [0] * 12 + [1] * 2))
    assert seen.faces[:14].tolist() == faces
    assert sorted(map(sorted, seen.faces[14:].tolist())) == [[8, 9, 10], [8, 10, 11]]
    assert seen.faces[14:].tolist() == [face[::-1] for face in faces[12:]]
    assert seen.face_instance[14:].tolist() == seen.face_material[14:].tolist() == [1, 1]


def test_seams_of_a_texture_leave_a_body_closed() -> None:
    cube = np.array([[i & 1, i >> 1 & 1, i >> 2] for i in range(8)]) * 100
    corners = cube[np.array(_CUBE).ravel()]
    faces = np.arange(36).reshape(-1, 3).tolist()
    assert len(with_backs(scene_of(corners, faces, [0] * 12)).faces) == 12
