"""`hypernav find` with a real, tiny model: its words are nonsense, and the search lives on."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from box_scenes import room_glb
from hypernav.app.cli.main import main

STEPS = 5


def find(glb: Path, out: Path, *arguments: str, device: str = "cpu") -> dict:
    """Run a short search; its result.json."""
    camera = ("embodiment.camera.width=160", "embodiment.camera.height=120")
    few = ("grounding.max_tokens=16", "block_choice.max_tokens=16")
    chosen = ("block_choice.mode=constrained",)  # its answers have probabilities
    options = ("--scene", str(glb), "--out", str(out), "--start", "1", "2", "180")
    settings = (
        "--set",
        *camera,
        *few,
        *chosen,
        "search.look_around_at_start=false",
        f"chat.device={device}",
    )
    command = ["find", "bed", *options, "--max-steps", str(STEPS), *arguments, *settings]
    with pytest.raises(SystemExit) as stop:
        main(command)
    assert stop.value.code == 1
    return json.loads((out / "result.json").read_text())


@pytest.fixture(scope="module")
def glb(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return room_glb(tmp_path_factory.mktemp("scene") / "room.glb")


def check(out: Path, result: dict) -> None:
    steps = [json.loads(line) for line in (out / "trace.jsonl").read_text().splitlines()]
    exchanges = [one for step in steps for one in step["exchanges"] if one["by_model"]]
    total = result["ledger"]["total"]
    assert (result["outcome"], result["steps"], len(steps)) == ("not_found", STEPS, STEPS)
    assert total["calls"] == len(exchanges) >= STEPS
    assert total["tokens_in"] == sum(one["tokens_in"] for one in exchanges) > 20 * STEPS
    assert {one["kind"] for one in exchanges} >= {"ground", "choose block"}
    chosen = [one for one in exchanges if one["kind"] == "choose block"]
    assert all(sum(one["probabilities"].values()) == pytest.approx(1.0) for one in chosen)


def test_through_transformers_serve(glb: Path, tmp_path: Path, transformers_server: str):
    live, again, book = tmp_path / "live", tmp_path / "again", tmp_path / "book.jsonl"
    result = find(glb, live, "--vlm", transformers_server, "--record", str(book))
    check(live, result)
    find(glb, again, "--vlm", f"replay:{book}")
    assert (again / "trace.jsonl").read_bytes() == (live / "trace.jsonl").read_bytes()


def test_in_this_process(glb: Path, tmp_path: Path, tiny: Callable[[str], Path], device: str):
    vlm = f"local:{tiny('qwen25_vl')}"
    check(tmp_path, find(glb, tmp_path, "--vlm", vlm, device=device))


def test_doctor_names_what_is_wrong_with_it(
    transformers_server: str, capsys: pytest.CaptureFixture[str]
):
    with pytest.raises(SystemExit) as stop:
        main(["doctor", "--vlm", transformers_server])
    said = capsys.readouterr().out
    assert stop.value.code == 1
    assert "speaks the dialect 'transformers'" in said
    assert "no vision: asked about plain colours" in said
    assert "ok    constraints:" in said
