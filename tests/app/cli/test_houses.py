from pathlib import Path

import pytest

from box_houses import box_house
from hypernav.app.build.data.scenes import load_scene
from hypernav.app.cli import houses
from hypernav.app.cli.main import main
from hypernav.core.goal import Goal
from hypernav.lab.datasets.habitat_files import read_episodes
from hypernav.simulator.houses.building import house
from hypernav.simulator.houses.episodes import splits
from hypernav.simulator.houses.episodes.queries import near_misses
from hypernav.simulator.houses.export import building_page
from hypernav.simulator.houses.export.habitat_data import HabitatData
from hypernav.simulator.houses.generator import generate


@pytest.fixture(autouse=True)
def own_cache(tmp_path, monkeypatch):
    monkeypatch.setenv("HYPERNAV_CACHE", str(tmp_path / "cache"))


@pytest.fixture
def box_houses(monkeypatch):
    monkeypatch.setattr(splits, "cached_building", box_house)


def hypernav(*arguments):
    """Run the command; returns its exit status."""
    with pytest.raises(SystemExit) as stop:
        main([str(argument) for argument in arguments])
    return stop.value.code


@pytest.mark.slow
def test_episodes_are_written_and_their_difficulty_is_told(box_houses, tmp_path, capsys):
    out = tmp_path / "new" / "val.json.gz"
    options = ("--houses", "1000:1002", "--count", 5)
    assert hypernav("houses", "episodes", "houses-val", "--out", out, *options) == 0
    dataset = read_episodes(out)
    assert [e.scene_id for e in dataset.episodes] == ["houses:1000"] * 4 + ["houses:1001"]
    said = capsys.readouterr()
    assert said.out == ""
    for words in ("5 episodes in 2 buildings", "geodesic distance", "median"):
        assert words in said.err
    assert str(out) in said.err.replace("\n", "")


@pytest.mark.slow
def test_a_second_run_writes_the_same_bytes_from_the_cache(box_houses, tmp_path, monkeypatch):
    command = ("houses", "episodes", "houses-ovon", "--houses", "2000:2001", "--quiet", "--out")
    assert hypernav(*command, tmp_path / "a.json.gz") == 0
    monkeypatch.setattr(splits, "cached_building", None)
    assert hypernav(*command, tmp_path / "b.json.gz") == 0
    assert (tmp_path / "a.json.gz").read_bytes() == (tmp_path / "b.json.gz").read_bytes()


def test_quiet_says_nothing(box_houses, tmp_path, capsys):
    options = ("--out", tmp_path / "a.json", "--houses", "5:6", "--quiet")
    assert hypernav("houses", "episodes", "houses-train", *options) == 0
    said = capsys.readouterr()
    assert said.out == said.err == ""


def test_splits_are_listed(capsys):
    assert hypernav("houses", "splits") == 0
    said = capsys.readouterr().out
    for words in ("houses-val", "1000:1036", "houses-ovon", "2000:2036", "houses-train"):
        assert words in said


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["houses-vall", "--out", "a.json"], "did you mean 'houses-val'"),
        (["houses-val", "--out", "a.txt"], "ends in .json.gz or .json"),
        (["houses-val"], "--out"),
        (["houses-val", "--out", "a.json", "--houses", "5"], "expected FIRST:END"),
        (["houses-val", "--out", "a.json", "--houses", "-1:4"], "--houses"),
        (["houses-val", "--out", "a.json", "--houses", "5:9"], "houses 1000:1036"),
        (["houses-train", "--out", "a.json", "--houses", "1000:1002"], "belong to houses-val"),
        (["houses-val", "--out", "a.json", "--count", "0"], "1 to 1000"),
        (["houses-val", "--out", "a.json", "--houses", "1000:1001", "--count", "29"], "1 to 28"),
    ],
)
def test_bad_input_is_one_line_with_the_remedy(arguments, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert hypernav("houses", "episodes", *arguments) == 2
    said = capsys.readouterr().err
    assert words in said
    assert said.count("\n") == 1
    assert said.startswith("hypernav: ")
    assert not (tmp_path / "a.json").exists()


def test_a_place_that_cannot_be_written_is_one_line(box_houses, tmp_path, capsys):
    (tmp_path / "file").write_text("not a folder")
    options = ("--out", tmp_path / "file" / "a.json", "--houses", "5:6", "--quiet")
    assert hypernav("houses", "episodes", "houses-train", *options) == 2
    said = capsys.readouterr().err
    assert "a.json cannot be written (Not a directory)" in said
    assert said.count("\n") == 1


def test_a_house_without_a_number_shows_the_form(capsys):
    assert hypernav("find", "bed", "--scene", "houses:", "--quiet") == 2
    assert "scene 'houses:': expected houses:N" in capsys.readouterr().err


@pytest.mark.parametrize("number", ["abc", "-1", "1.5", "1234567890", "٣"])
def test_a_scene_that_is_no_house_is_one_line(number, capsys):
    assert hypernav("find", "bed", "--scene", f"houses:{number}", "--quiet") == 2
    said = capsys.readouterr().err
    assert f"there is no house '{number}'" in said
    assert "houses:1234" in said
    assert said.count("\n") == 1


def test_houses_are_scenes_by_name(monkeypatch):
    monkeypatch.setattr("hypernav.simulator.houses.named_scenes.cached_building", box_house)
    assert load_scene("houses:1234").name == "houses:1234"
    assert load_scene("builtin").name == "houses:0"


def test_a_house_is_exported_and_opens_again(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert hypernav("houses", "export", "0") == 0
    said = capsys.readouterr().err
    glb = Path("runs/house-0/house_0.glb")
    assert f"--scene {glb}" in said
    assert "scene_dataset_config.json" in said
    assert len(load_scene(str(glb)).instances) > 40


def test_an_interrupted_export_of_a_house_says_that_it_is_not_complete(
    tmp_path, monkeypatch, capsys
):
    def interrupted(building, folder):
        raise KeyboardInterrupt

    monkeypatch.setattr(houses, "export_building", interrupted)
    assert hypernav("houses", "export", "0", "--out", tmp_path / "house") == 130
    said = " ".join(capsys.readouterr().err.split())
    assert said.startswith("building house 0, to be written to")
    assert f"interrupted; {tmp_path / 'house'} is not complete. Run the same command again" in said


def test_a_split_is_exported_with_its_episodes(box_houses, tmp_path, monkeypatch, capsys):
    asked = {}

    def export(dataset, split, root, *, progress):
        asked.update(dataset=dataset, split=split, root=root)
        return HabitatData(root, split)

    monkeypatch.setattr(houses, "export_split", export)
    assert hypernav("houses", "export", "houses-val#1000:1002", "--out", tmp_path / "data") == 0
    assert {e.scene_id for e in asked["dataset"].episodes} == {"houses:1000", "houses:1001"}
    assert (asked["split"], asked["root"]) == ("houses-val", tmp_path / "data")
    said = capsys.readouterr().err
    for words in ("data_path=", "scenes_dir=", "scene_dataset=", "hypernav eval habitat:"):
        assert words in said


@pytest.mark.parametrize(
    ("what", "words"),
    [
        ("houses-vall", "did you mean 'houses-val'"),
        ("houses-val#5:9", "houses-val has the houses 1000:1036"),
        ("houses-val#", "nothing follows the #"),
        ("houses-val#all", "expected house numbers"),
    ],
)
def test_a_split_that_does_not_exist_is_not_exported(what, words, tmp_path, capsys):
    assert hypernav("houses", "export", what, "--out", tmp_path / "data") == 2
    said = capsys.readouterr().err
    assert words in said
    assert said.count("\n") == 1
    assert not (tmp_path / "data").exists()


def test_a_house_is_shown_on_a_page(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(
        building_page, "_page", lambda building, progress: f"page of {building.scene}"
    )
    assert hypernav("houses", "show", "houses:12", "--out", tmp_path / "new") == 0
    path = tmp_path / "new" / "house_12.html"
    assert str(path) in capsys.readouterr().err.replace("\n", "")
    assert path.read_text() == "page of houses:12"


@pytest.mark.slow
def test_other_buildings_are_shown_by_the_name_of_their_scene(tmp_path, monkeypatch):
    monkeypatch.setattr(
        building_page, "_page", lambda building, progress: f"page of {building.scene}"
    )
    assert hypernav("houses", "show", "shops:12", "--out", tmp_path, "--quiet") == 0
    assert (tmp_path / "shop_12.html").read_text() == "page of shops:12"


def test_offices_and_shops_are_scenes_by_name(monkeypatch):
    monkeypatch.setattr("hypernav.simulator.houses.named_scenes.cached_building", box_house)
    assert load_scene("offices:7").name == "offices:7"
    assert load_scene("shops:1234").name == "shops:1234"


@pytest.mark.parametrize("command", ["export", "show"])
def test_what_is_no_house_and_where_nothing_can_be_written_is_one_line(command, tmp_path, capsys):
    (tmp_path / "file").write_text("in the way")
    for arguments, words in (
        (["abc"], "there is no house 'abc'"),
        (["offices:abc"], "there is no office 'abc'"),
        (["castles:7"], "there are no generated 'castles'; expected houses:N, offices:N, shops:N"),
        (["0", "--out", tmp_path / "file" / "in"], "cannot be written"),
        ([], "Number of a house"),
    ):
        assert hypernav("houses", command, *arguments) == 2
        said = capsys.readouterr().err
        assert words in said
        assert said.count("\n") == 1


HOUSE_IN_THE_DOCS = 1234


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("L-shaped sofa", 1),
        ("settee", 1),
        ("bedside table", 3),
        ("the black chair in the office", 1),
        ("the blue chair beside the desk", 1),
        ("the red chair in the office", 0),
        ("the black chair in the kitchen", 0),
    ],
)
def test_phrases_of_the_docs_mean_what_they_say(house_of_the_docs, text, count):
    satisfying = [
        i for i in house_of_the_docs.instances if i.label and i.label.satisfies(Goal(text))
    ]
    assert len(satisfying) == count
    if count == 1:
        assert near_misses(house_of_the_docs.instances, Goal(text))


@pytest.fixture(scope="module")
def house_of_the_docs():
    return generate(house(HOUSE_IN_THE_DOCS))
