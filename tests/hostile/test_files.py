"""What a stranger may send ends in one line that says what is wrong, soon and in little memory."""

import json
import os
from pathlib import Path
from typing import Any

import pytest

from hostile import hostile_records as records
from hostile import hostile_scenes as scenes
from hostile.commands import check, run
from hostile.hostile_values import NO_CONFIGURATION, NO_JSON, VALUES
from hypernav.app.build.presets import HyPerNavConfig

pytestmark = pytest.mark.slow

LOOKED_AT = (0, 1, 2)
"""Exit statuses of a file that may well be usable."""


def leaves(values: dict[str, Any], section: str = "") -> list[str]:
    """Names of all numbers in a configuration."""
    names = []
    for key, value in values.items():
        if isinstance(value, dict):
            names += leaves(value, f"{section}{key}.")
        elif isinstance(value, int | float) and not isinstance(value, bool):
            names.append(section + key)
    return names


@pytest.fixture(scope="module", autouse=True)
def compiled(tmp_path_factory: pytest.TempPathFactory):
    """A first run has the simulator compiled, which no later one has to wait for."""
    folder = tmp_path_factory.mktemp("first")
    scenes.sound().write(folder / "scene.glb")
    run(["find", "chair", "--max-steps", "2", "--scene", "scene.glb"], folder, seconds=300)


def find(folder: Path, *arguments: str | Path):
    return run(["find", "chair", "--max-steps", "1", "--quiet", *arguments], folder)


@pytest.mark.parametrize("value", ["9" * 30, "-" + "9" * 30, ".nan", "-.inf", "[1]"])
@pytest.mark.parametrize("name", leaves(HyPerNavConfig().model_dump()))
def test_numbers_of_the_configuration(name, value, tmp_path):
    check(find(tmp_path, "--set", f"{name}={value}"), 2, name)


@pytest.mark.parametrize("name", NO_CONFIGURATION)
def test_configurations(name, tmp_path):
    (tmp_path / "a.yaml").write_text(NO_CONFIGURATION[name])
    check(find(tmp_path, "--config", "a.yaml"), 2, "hypernav: ")


@pytest.mark.parametrize(
    "arguments",
    [
        ["find", "bed", "--start", "nan", "nan", "nan"],
        ["find", "bed", "--start", "inf", "0", "0"],
        ["find", "bed", "--start", "1e300", "0", "0"],
        ["find", "bed", "--start", "0", "0", "1e300"],
        ["find", "bed", "--max-steps", "0"],
        ["find", "bed", "--max-steps", "9" * 400],
        ["find", "bed", "--seed", "-1"],
        ["find", "bed", "--seed", "9" * 5000],
        ["find", "bed", "--scene", "houses:" + "9" * 5000],
        ["find", "bed", "--scene", "houses:-1"],
        ["find", "bed", "--set", "own." + "a." * 5000 + "a=1"],
        ["find", "bed", "--set", "x" * 50_000 + "=1"],
        ["find", "bed", "--set", "mapping.cell_size_m=" + "9" * 50_000],
        ["find", "bed", "--set", "mapping.cell_size_m=[" * 5000],
        ["find", "bed", "--set", "mapping.cell_size_m=&a [*a]"],
        ["find", "bed", "--set", "mapping={min_points: 1, min_points: 2}"],
        ["find", "bed", "--set", "mapping.cell_size_m=2001-99-99"],
        ["eval", "houses-val", "--success-distance", "nan"],
        ["eval", "houses-val", "--success-distance", "inf"],
        ["eval", "houses-val", "--success-distance", "1e300"],
        ["eval", "houses-val", "--workers", "1000000"],
        ["eval", "houses-val", "--workers", "-1"],
        ["eval", "houses-val", "--max-steps", "9" * 30],
        ["eval", "houses-train#0:999999999"],
        ["eval", "houses-train#" + "9" * 5000],
        ["eval", "scene:builtin#" + "9" * 9],
        ["eval", "scene:builtin#" + "9" * 5000],
        ["eval", "scene:builtin#nan"],
        ["houses", "episodes", "houses-train", "--out", "a.json", "--houses", "0:" + "9" * 5000],
    ],
    ids=lambda arguments: " ".join(arguments)[:60],
)
def test_options(arguments, tmp_path):
    check(run([*arguments, "--quiet"], tmp_path), 2)


WHERE = {
    "scene.glb": ["find", "chair", "--scene", "{}"],
    "scene.gltf": ["find", "chair", "--scene", "{}"],
    "scene.obj": ["find", "chair", "--scene", "{}"],
    "scene.ply": ["find", "chair", "--scene", "{}"],
    "a.yaml": ["find", "chair", "--scene", "sound.glb", "--max-steps", "1", "--config", "{}"],
    "a.jsonl": ["find", "chair", "--vlm", "replay:{}"],
    "a.onnx": ["find", "chair", "--detector", "yolox:{}"],
    "a.json.gz": ["eval", "habitat:{}"],
    "run.json": ["report", "."],
    "objects.json": ["find", "chair", "--scene", "sound.glb", "--max-steps", "1"],
}
"""Command lines that read a file."""


@pytest.mark.parametrize("kind", ["device", "pipe", "folder", "dangling", "large", "empty"])
@pytest.mark.parametrize("name", WHERE)
def test_what_is_no_file_of_limited_size(name, kind, tmp_path):
    scenes.sound().write(tmp_path / "sound.glb")
    place(tmp_path / name, kind)
    arguments = [argument.format(name) for argument in WHERE[name]]
    usable = (name, kind) in {("a.yaml", "empty"), ("objects.json", "dangling")}
    check(run(arguments, tmp_path), LOOKED_AT if usable else 2)


def place(path: Path, kind: str) -> None:
    """Put something where a file is expected."""
    match kind:
        case "device":
            path.symlink_to("/dev/zero")
        case "pipe":
            os.mkfifo(path)
        case "folder":
            path.mkdir()
        case "dangling":
            path.symlink_to("nowhere")
        case "large":
            with path.open("wb") as file:
                file.truncate(3_000_000_000)
        case _:
            path.touch()


def load(content: Any, folder: Path, name: str = "scene.glb"):
    return find(folder, "--scene", scenes.write(content, folder / name))


@pytest.mark.parametrize("name", scenes.WHOLE_FILES)
def test_scene_files(name, tmp_path):
    check(load(scenes.WHOLE_FILES[name], tmp_path), 2, "scene.glb")


@pytest.mark.parametrize("name", NO_JSON)
def test_scenes_of_other_json(name, tmp_path):
    check(load(scenes.as_glb(NO_JSON[name]), tmp_path), 2, "scene.glb")
    check(load(NO_JSON[name], tmp_path, "scene.gltf"), 2, "scene.gltf")


TOO_LARGE = {
    "png 30000",
    "png 2 billion",
    "png wide",
    "png 16 bit",
    "jpeg 65500",
    "webp 16383",
    "webp 16 million",
}


@pytest.mark.parametrize("name", scenes.IMAGES)
def test_textures(name, tmp_path):
    ended = load(scenes.with_texture(scenes.IMAGES[name]), tmp_path)
    if name in TOO_LARGE:
        check(ended, 2, "texture 0")
    else:
        check(ended, (0, 1))  # a broken texture leaves a plain colour


@pytest.mark.parametrize("name", scenes.ACCESSORS)
def test_accessors(name, tmp_path):
    check(load(scenes.with_accessor(scenes.ACCESSORS[name]), tmp_path), 2, "scene.glb")


@pytest.mark.parametrize("name", scenes.NODES)
def test_nodes(name, tmp_path):
    check(load(scenes.with_nodes(scenes.NODES[name]()), tmp_path), LOOKED_AT)


@pytest.mark.parametrize("kind", ["images", "buffers"])
@pytest.mark.parametrize("uri", scenes.REFERENCES, ids=lambda uri: uri[:30])
def test_references(uri, kind, tmp_path):
    folder = tmp_path / "scene"
    folder.mkdir()
    place(folder / "pipe", "pipe")
    place(folder / "zero", "device")
    place(folder / "folder", "folder")
    (tmp_path / "scene.bin").write_bytes(bytes(1000))
    ended = load(scenes.with_reference(uri, kind), folder)
    if kind == "images":
        check(ended, (0, 1))  # a missing texture leaves a plain colour
    else:
        check(ended, 2, "scene.glb")


BROKEN = dict(scenes.broken_documents(VALUES))


@pytest.mark.parametrize("name", BROKEN)
def test_documents(name, tmp_path):
    check(load(BROKEN[name], tmp_path), LOOKED_AT)


@pytest.mark.parametrize("name", NO_JSON)
def test_descriptions_of_objects(name, tmp_path):
    (tmp_path / "objects.json").write_bytes(NO_JSON[name])
    check(load(scenes.sound(), tmp_path), LOOKED_AT if name == "utf-16" else 2)


@pytest.mark.parametrize("name", NO_JSON)
def test_episode_files_of_other_json(name, tmp_path):
    (tmp_path / "a.json").write_bytes(NO_JSON[name])
    check(run(["eval", "habitat:a.json", "--quiet"], tmp_path), 2, "a.json")


@pytest.mark.parametrize("name", records.PACKED)
def test_packed_episode_files(name, tmp_path):
    (tmp_path / "a.json.gz").write_bytes(records.PACKED[name]())
    check(run(["eval", "habitat:a.json.gz", "--quiet"], tmp_path), 2, "a.json.gz")


@pytest.mark.parametrize("name", NO_JSON)
def test_recordings(name, tmp_path):
    (tmp_path / "a.jsonl").write_bytes(NO_JSON[name])
    check(find(tmp_path, "--vlm", "replay:a.jsonl"), 2, "a.jsonl")
    header = json.dumps(records.HEADER).encode()
    (tmp_path / "a.jsonl").write_bytes(header + b"\n{}\n" + NO_JSON[name])
    check(find(tmp_path, "--vlm", "replay:a.jsonl"), 2, "a.jsonl")


@pytest.mark.parametrize("file", ["run.json", "episodes.jsonl"])
@pytest.mark.parametrize("name", NO_JSON)
def test_run_folders(name, file, tmp_path):
    (tmp_path / "run.json").write_text(json.dumps({"configuration": records.RUN}))
    (tmp_path / file).write_bytes(NO_JSON[name])
    check(run(["report", "."], tmp_path), 2)


@pytest.mark.parametrize("name", ["loop", "loop/below", "x" * 300, "pipe"])
def test_what_is_no_recording_of_a_robot(name, tmp_path):
    (tmp_path / "loop").symlink_to("loop")
    place(tmp_path / "pipe", "pipe")
    check(run(["robot", "replay", name], tmp_path), 2, "hypernav: ")


MESHES = {
    "a.obj": b"v 0 0 0\nv nan 0 0\nv 1e999 1 0\nf 1 2 3\n",
    "index.obj": b"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 999999999\n",
    "material.obj": b"mtllib /dev/zero\nusemtl a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n",
    "text.obj": b"hello\n" * 1000,
    "a.stl": bytes(80) + b"\xff\xff\xff\xff" + bytes(50),
    "b.stl": b"solid x\nfacet normal nan nan nan\n",
    "a.off": b"OFF\n1000000000 1000000000 0\n",
    "b.off": b"OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 7\n",
    "a.ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 1000000000\n"
    b"property float x\nend_header\n",
    "b.ply": b"ply\nformat ascii 1.0\nelement vertex 3\n"
    b"property list uchar int x\nend_header\n1 2 3",
}
"""Meshes of other formats."""


@pytest.mark.parametrize("name", MESHES)
def test_meshes(name, tmp_path):
    check(load(MESHES[name], tmp_path, name), 2)
