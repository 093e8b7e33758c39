import pytest

from hypernav.worlds.scenes.node_names import category_of, is_structural, words_of


@pytest.mark.parametrize(
    ("name", "category"),
    [
        ("Bed_01_001", "bed"),
        ("dining-table.003", "dining table"),
        ("SM_OfficeChair2", "office chair"),
        ("TVCabinet_01_001", "tv cabinet"),
        ("ChairA_01_004", "chair"),
        ("SofaC_01_001__1", "sofa"),
        ("potted plant", "potted plant"),
        ("Sofa_LOD0", "sofa"),
        ("geo_Lamp_low", "lamp"),
        ("wall_clock", "wall clock"),
        ("floor-lamp.001", "floor lamp"),
        ("Toilet.fbx", "toilet"),
        ("TV", "tv"),
        ("cabinet_lower_left", "cabinet lower left"),
        ("wall_clock_kitchen", "wall clock kitchen"),
        ("aws_robomaker_residential_SofaC_01", "sofa"),
        ("floor2_aws_robomaker_hospital_curtain_open", "curtain open"),
        ("desk_brown_clone_clone", "desk brown"),
        ("chair_visual", "chair"),
        ("床_01", "床"),
        ("办公室_床", "办公室 床"),
        ("ESS_Küchentisch.001", "ess küchentisch"),
    ],
)
def test_names_become_words(name: str, category: str) -> None:
    assert category_of(name) == category


@pytest.mark.parametrize(
    "name",
    [
        "RoomWall_01_001",
        "HouseWallB_01_001",
        "FloorB_01_001",
        "Ceiling.002",
        "living_room_floor",
        "door_frame_01",
        "DoorFrame",
        "window-frame",
        "walls",
        "Roof",
        "wall_north",
        "WallOuterLeft_02",
        "floor_kitchen",
        "aws_HouseWallB_01_visual",
        "ground_plane",
    ],
)
def test_the_building_itself_has_no_category(name: str) -> None:
    assert is_structural(name)
    assert category_of(name) is None


@pytest.mark.parametrize(
    "name",
    [
        "Object_4",
        "Cube.003",
        "mesh",
        "RootNode",
        "node 12",
        "",
        "001",
        "Sketchfab_model",
        "SketchUp",
        "link_0",
        "collada_visual_scene_1",
        "8c1e1fb2-0f3a-4d5e-9a7b-6c2d41e0f9aa",
    ],
)
def test_names_that_say_nothing_have_no_category(name: str) -> None:
    assert category_of(name) is None


def test_a_single_word_is_never_taken_away() -> None:
    assert words_of("Mesh_01") == ("mesh",)
    assert words_of("A1") == ("a",)
