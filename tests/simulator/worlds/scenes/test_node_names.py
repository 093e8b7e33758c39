import pytest

from hypernav.core.naming.labels import same_name
from hypernav.simulator.worlds.scenes.node_names import category_of, is_structural, words_of


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
        ("Door mat", "door mat"),
        ("SM_DoorMat_01", "door mat"),
        ("Floor_Mat.002", "floor mat"),
        ("Bath mat", "bath mat"),
        ("Wall_Mirror", "wall mirror"),
        ("Doll house", "doll house"),
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


@pytest.mark.parametrize(
    ("name", "category"),
    [
        ("M_Bed-Standard:1525 x 2007mm - Queen:168449", "standard bed"),
        ("M_Bed-Standard:1525 x 2007mm - Queen:168449#2", "standard bed"),
        ("M_Table-Coffee:600 x 600 x 600mm:1234", "coffee table"),
        ("M_Table-Dining Round w Chairs:0915mm Diameter:1234", "dining table"),
        ('Table-Night Stand:24" x 18":99', "night table"),
        ("M_Floor Lamp - Shaded:60W - 120V:8", "shaded floor lamp"),
        ("M_Chair-Executive [212345]", "executive chair"),
        ("IfcFurniture/Chair", "chair"),
        ("IfcFurnishingElement/M_Desk:1800x900:44", "desk"),
        ("IfcLightFixture/2O2Fr$t4X7Zf8NOew3FLOH", "light fixture"),
        ("IfcSanitaryTerminal", "sanitary terminal"),
        ("IfcFurniture_Sofa_01", "sofa"),
        ("room:Bed_01", "room bed"),
        ("M_Chair-Task:Chair-Task:138999 #5000", "task chair"),
        ("Chair_Office_Swivel:Std:44", "office chair"),
        ("Furniture_Sofa_Corbu:3 seat:331", "corbu sofa"),
        ("Lamp, Floor:Floor lamp:43", "floor lamp"),
        ("Door mat:Coir:1234", "door mat"),
        ("IfcFurniture/Door mat", "door mat"),
        ("Window seat:1200mm:77", "window seat"),
        ("Column radiator:600mm:78", "column radiator"),
        ("Refrigerator-Two-Door:900mm:79", "two refrigerator"),
        ("M_Wardrobe-Door Double:1200mm:80", "door wardrobe"),
    ],
)
def test_names_of_building_models_become_words(name: str, category: str) -> None:
    assert category_of(name) == category


@pytest.mark.parametrize(
    "name",
    [
        "Basic Wall:Interior - 135mm Partition:123456",
        "Basic Wall:Interior - 135mm Part.001",
        "Basic Wall [198694]",
        "Floor:Generic 150mm:12",
        "Basic Roof:Generic - 400mm:1",
        "Compound Ceiling:600 x 600mm Grid:7",
        "Railing:Handrail - Rectangular:151210",
        "M_Single-Flush:0915 x 2134mm:146596",
        "Curtain Wall:Storefront:5",
        "Rectangular Mullion:50 x 150mm:6",
        "IfcStairFlight/Assembled Stair:Stair:151086 Run 1",
        "IfcWall/Living room",
        "IfcWallStandardCase/SW - 001",
        "IfcCovering/Parquet",
        "IfcDoor/Front door",
        "IfcSlab",
        "Stair-004",
        "Slab - 012",
        "Basic Wall:Interior - Partition (92mm Stud):138584 #4131",
        "Opening1",
        "IFCWALL_#123",
        "Wall_Ext [99]",
        "Door:0915 x 2134mm:1",
        "Door-Interior:Single:2",
        "Doors_ExtDbl_Flush:1810x2110mm:3",
        "Door - Single - Panel:900:4",
        "Window Frame:900:5",
        "Door Interior Flush:900:6",
        "Windows 2:900:7",
        "M_Concrete-Rectangular-Column:300 x 450mm:8",
        "Opening Double:900:9",
        "M_Fixed with Trim:0915 x 1220mm:234567",
        "Double Hung with Trim:36in:10",
        "M_Slider with Trim:0915:11",
        "M_Awning-with trim:12:12",
        "Archtop with Trim:13:13",
        "Curtain Wall Dbl Glass:14:14",
        "Single-Raised Panel with Sidelights:15:15",
        "M_Sliding-Closet:1830 x 2134mm:16",
        "Overhead-Sectional:2438 x 2134mm:17",
        "Garage Door:2440 x 2130mm:18",
        "Baluster - Round:19:19",
    ],
)
def test_a_building_model_says_what_is_the_building(name: str) -> None:
    assert is_structural(name)
    assert category_of(name) is None


def test_a_door_mat_is_a_doormat() -> None:
    assert same_name(str(category_of("SM_DoorMat_01")), "doormat")


@pytest.mark.parametrize(
    "name",
    [
        "2O2Fr$t4X7Zf8NOew3FLOH",
        "product-4e2e5a5c-1111-2222-3333-444455556666-body",
        "IfcBuildingElementProxy/2O2Fr$t4X7Zf8NOew3FLOH",
        "IfcFurniture",
        "0RDVTmkVv60xF$yp_gU2jx:1",
    ],
)
def test_identifiers_of_building_models_are_no_names(name: str) -> None:
    assert category_of(name) is None
