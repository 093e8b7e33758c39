"""IFC files are scenes, with the extra; without it an error says how to convert them."""

import importlib.util

import pytest

from hypernav.core.errors import MissingExtraError, SceneError
from hypernav.core.goal import Goal
from hypernav.simulator.worlds.scenes.loading import read_scene
from hypernav.simulator.worlds.surface.walkable import WalkableGrid
from ifc_writer import Product, write_ifc

BED = "M_Bed-Standard:1525 x 2007mm - Queen:168449"
ROOM: list[Product] = [
    ("IfcSlab", "Floor:Generic 100mm:1", (-100, -100, -100), (6100, 4100, 0)),
    ("IfcWall", "Basic Wall:Exterior:2", (-100, -100, 0), (6100, 0, 2500)),
    ("IfcWall", "Basic Wall:Exterior:3", (-100, 4000, 0), (6100, 4100, 2500)),
    (
        "IfcFurniture",
        BED,
        (4000, 100, 0),
        (5900, 1700, 500),
    ),
    (
        "IfcFurniture",
        BED,
        (100, 100, 0),
        (1900, 1700, 500),
    ),
]
has_ifc = importlib.util.find_spec("ifcopenshell") is not None


@pytest.mark.skipif(has_ifc, reason="it is read")
def test_without_the_extra_an_error_says_how_to_get_it_or_convert(tmp_path):
    path = write_ifc(tmp_path / "room.ifc", ROOM)
    with pytest.raises(MissingExtraError, match=r"hypernav\[ifc\].*IfcConvert .*room\.glb"):
        read_scene(path)


@pytest.mark.skipif(not has_ifc, reason="needs the extra ifc")
class TestWithTheExtra:
    def test_products_are_things_in_metres_with_colours(self, tmp_path):
        scene = read_scene(write_ifc(tmp_path / "room.ifc", ROOM))
        beds = [i for i in scene.instances if i.label is not None]
        assert [bed.label.satisfies(Goal("bed")) for bed in beds if bed.label] == [True, True]
        assert beds[0].box_max == pytest.approx((5.9, 1.7, 0.5), abs=1e-5)
        assert {one.color for one in scene.materials} == {(0.8, 0.2, 0.1)}
        assert WalkableGrid.from_scene(scene).floor_z == pytest.approx(0.0, abs=1e-3)

    def test_a_building_at_coordinates_of_a_map_is_moved_to_the_origin(self, tmp_path, caplog):
        far = [
            (kind, name, *([a + 4.5e8, b, c] for a, b, c in (low, high)))
            for kind, name, low, high in ROOM
        ]
        scene = read_scene(write_ifc(tmp_path / "far.ifc", far))  # pyright: ignore[reportArgumentType]
        assert abs(scene.vertices).max() < 10.0
        assert "is moved by (-4500" in caplog.text

    def test_what_is_no_ifc_is_an_error_of_one_line(self, tmp_path):
        path = tmp_path / "bad.ifc"
        path.write_text("hello")
        with pytest.raises(SceneError, match=r"^[^\n]*bad\.ifc: cannot be read as IFC \([^\n]*$"):
            read_scene(path)
