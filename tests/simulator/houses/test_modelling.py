import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hypernav.simulator.houses.modelling.curves import (
    ball,
    cylinder,
    lathe,
    rod,
    rounded_outline,
    tube,
)
from hypernav.simulator.houses.modelling.model import Mesh, join
from hypernav.simulator.houses.modelling.solids import box, cushion, prism

SIDE = st.floats(0.05, 3.0)

SOLIDS = {
    "box": box(1.0, 2.0, 3.0),
    "bevelled box": box(1.0, 2.0, 3.0, bevel=0.05),
    "cushion": cushion(1.0, 2.0, 0.4, radius=0.1, puff=0.05, flats=3),
    "prism": prism([(0, 0), (1, 0), (1, 1), (0.5, 0.4), (0, 1)], 2.0),
    "round prism": prism(rounded_outline(1.0, 0.6, 0.2), 0.5),
    "cylinder": cylinder(0.5, 1.0),
    "bevelled cylinder": cylinder(0.5, 1.0, bevel=0.05),
    "ball": ball(1.0, 2.0, 0.5),
    "vase": lathe([(0, 0), (0.3, 0), (0.35, 0.5), (0.2, 0.6), (0, 0.6)]),
    "rod": rod((0, 0, 0), (0.3, 0.4, 0.5), 0.1, end_radius=0.05),
    "tube": tube([(0, 0, 0), (0, 0, 1), (0, 1, 1)], 0.1),
    "ring": tube(
        [(math.cos(a), math.sin(a), 0) for a in np.arange(12) * math.pi / 6], 0.1, closed=True
    ),
}


def volume(mesh: Mesh) -> float:
    a, b, c = (mesh.positions[mesh.faces[:, k]] for k in range(3))
    return float((a * np.cross(b, c)).sum()) / 6.0


@pytest.mark.parametrize("name", SOLIDS)
def test_solids_are_closed_face_outwards_and_have_unit_normals(name: str):
    mesh = SOLIDS[name]
    assert np.allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-9)
    corners = mesh.positions[mesh.faces]
    wound = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(wound, axis=1)
    shaded = mesh.normals[mesh.faces].mean(axis=1)
    agree = (wound * shaded).sum(axis=1)[area > 1e-9] / area[area > 1e-9]
    assert agree.min() > 0.2
    assert volume(mesh) > 0.0
    # The sum of the area vectors of a closed surface is zero.
    assert np.allclose(wound.sum(axis=0), 0.0, atol=1e-9)


@given(SIDE, SIDE, SIDE)
@settings(max_examples=30, deadline=None)
def test_a_box_has_its_size_and_stands_on_its_place(x: float, y: float, z: float):
    mesh = box(x, y, z, at=(1.0, 2.0, 3.0), bevel=0.01)
    assert np.allclose(mesh.positions.min(axis=0), (1.0 - x / 2, 2.0 - y / 2, 3.0))
    assert np.allclose(mesh.positions.max(axis=0), (1.0 + x / 2, 2.0 + y / 2, 3.0 + z))


@given(SIDE, SIDE)
@settings(max_examples=30, deadline=None)
def test_a_cylinder_tends_to_its_volume(radius: float, height: float):
    exact = math.pi * radius**2 * height
    assert volume(cylinder(radius, height, sides=64)) == pytest.approx(exact, rel=0.01)


@given(st.floats(-360.0, 360.0), st.sampled_from("xyz"))
@settings(max_examples=30, deadline=None)
def test_turning_back_and_forth_changes_nothing(degrees: float, axis: str):
    mesh = SOLIDS["vase"]
    back = mesh.turned(degrees, axis).turned(-degrees, axis)
    assert np.allclose(back.positions, mesh.positions, atol=1e-12)
    assert volume(mesh.turned(degrees, axis)) == pytest.approx(volume(mesh))


def test_mirroring_keeps_the_outside_outside():
    assert volume(SOLIDS["prism"].scaled(-1.0, 1.0, 1.0)) == pytest.approx(volume(SOLIDS["prism"]))


def test_joining_adds_volumes():
    both = join([SOLIDS["box"], SOLIDS["ball"].moved(5, 5, 5)])
    assert volume(both) == pytest.approx(volume(SOLIDS["box"]) + volume(SOLIDS["ball"]))
