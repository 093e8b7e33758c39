"""`hypernav find --vlm`: what it writes, how it ends, and how it repeats itself."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from box_scenes import room_glb
from eval_runs import write_exam
from hypernav.app.cli.main import main
from servers.scripted import ScriptedServer, closed_port
from servers.truth import Truth, TruthfulBrain, watching

QUICK = ("chat.first_wait_s=0.01", "chat.longest_wait_s=0.1", "chat.patience_s=5")
SMALL = ("--set", "embodiment.camera.width=160", "embodiment.camera.height=120", *QUICK)
MODEL = "scripted/Qwen2.5-VL-7B"
START = ("--start", "1", "2", "180")


@pytest.fixture(scope="module")
def glb(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return room_glb(tmp_path_factory.mktemp("scene") / "room.glb")


@pytest.fixture
def server() -> Iterator[ScriptedServer]:
    with ScriptedServer() as server, watching(Truth()) as truth:
        server.brain = TruthfulBrain(truth)
        yield server


def find(glb: Path, out: Path, *arguments: object) -> tuple[int, dict]:
    """Run the command; its exit status and result.json."""
    command = ["find", "bed", "--scene", glb, "--out", out, *START, *arguments]
    with pytest.raises(SystemExit) as stop:
        main([str(argument) for argument in (*command, *SMALL)])
    return int(stop.value.code or 0), json.loads((out / "result.json").read_text())


def test_a_model_finds_the_bed_and_the_books_agree(
    glb: Path, tmp_path: Path, server: ScriptedServer
):
    prices = ("price.in_per_million=1", "price.out_per_million=10")
    status, result = find(glb, tmp_path, "--vlm", server.spec, "--set", *prices)
    assert (status, result["outcome"]) == (0, "found")
    total = result["ledger"]["total"]
    trace = [json.loads(line) for line in (tmp_path / "trace.jsonl").read_text().splitlines()]
    exchanges = [one for step in trace for one in step["exchanges"] if one["by_model"]]
    assert result["model_calls"] == total["calls"] == len(exchanges) == len(server.requests)
    assert total["tokens_in"] == sum(one["tokens_in"] for one in exchanges)
    cost = (total["tokens_in"] * 1.0 + total["tokens_out"] * 10.0) / 1e6
    assert result["ledger"]["cost"] == pytest.approx(cost)
    assert result["parts"]["vlm"] == server.spec
    page = (tmp_path / "index.html").read_text()
    assert "What the model was asked" in page
    assert "Is there a bed in this picture?" in page


@pytest.mark.slow
def test_a_recording_replays_to_the_same_bytes(glb: Path, tmp_path: Path, server: ScriptedServer):
    book, live, again = tmp_path / "book.jsonl", tmp_path / "live", tmp_path / "again"
    find(glb, live, "--vlm", server.spec, "--record", book, "--quiet")
    asked = len(server.requests)
    server.stop()
    status, _ = find(glb, again, "--vlm", f"replay:{book}", "--quiet")
    assert status == 0
    assert len(server.requests) == asked
    assert (live / "trace.jsonl").read_bytes() == (again / "trace.jsonl").read_bytes()


@pytest.mark.slow
def test_a_question_that_was_not_recorded_is_one_line(
    glb: Path, tmp_path: Path, server: ScriptedServer, capsys: pytest.CaptureFixture[str]
):
    book = tmp_path / "book.jsonl"
    find(glb, tmp_path / "a", "--vlm", server.spec, "--record", book, "--quiet")
    options = ["--scene", str(glb), "--out", str(tmp_path / "b"), "--vlm", f"replay:{book}"]
    with pytest.raises(SystemExit) as stop:
        main(["find", "bed", *options, "--start", "2", "1", "0", "--quiet", *SMALL])
    said = capsys.readouterr().err
    assert stop.value.code == 2
    assert "the nearest differs in images" in said
    assert said.count("\n") == 1


def test_a_server_that_dies_leaves_everything_up_to_then(
    glb: Path, tmp_path: Path, server: ScriptedServer, capsys: pytest.CaptureFixture[str]
):
    brain = server.brain

    def dying(asked):
        if len(server.requests) == 4:
            server.hang_s = 30.0
            server.plan.extend("hang" for _ in range(50))
        return brain(asked)

    server.brain = dying
    patience = ("--set", "chat.patience_s=0.6", "chat.timeout_s=0.2")
    with pytest.raises(SystemExit) as stop:
        main(
            [
                *("find", "bed", "--scene", str(glb), "--out", str(tmp_path), *START),
                *("--vlm", server.spec, *SMALL, *patience),
            ]
        )
    result = json.loads((tmp_path / "result.json").read_text())
    assert stop.value.code == 3
    assert (result["outcome"], result["success"], result["steps"]) == (
        "model_unavailable",
        False,
        4,
    )
    assert "patience of 0.6 s" in result["detail"]
    assert result["ledger"]["total"]["faults"] == {"unavailable": 1}
    assert len((tmp_path / "trace.jsonl").read_text().splitlines()) == 4
    assert (tmp_path / "map.yaml").is_file()
    told = capsys.readouterr().err
    assert "the model was unavailable" in told
    assert told.count("at this pace a search of about 53 questions takes") == 1
    assert "the model did not answer" in (tmp_path / "index.html").read_text()


def test_a_server_that_was_never_there(
    glb: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    with closed_port() as port:
        spec = f"openai:http://127.0.0.1:{port}/v1"
        arguments = ("--vlm", spec, "--set", "chat.patience_s=0.2", "chat.first_wait_s=0.05")
        command = ["find", "bed", "--scene", str(glb), "--out", str(tmp_path), *arguments]
        with pytest.raises(SystemExit) as stop:
            main(command)
    said = capsys.readouterr().err
    assert stop.value.code == 3
    assert "asking again" in " ".join(said.split())
    assert f"hypernav doctor --vlm {spec}" in " ".join(said.split())
    result = json.loads((tmp_path / "result.json").read_text())
    assert (result["outcome"], result["steps"]) == ("model_unavailable", 0)


def test_a_wrong_key_is_an_error_and_what_was_done_is_on_disk(
    glb: Path, tmp_path: Path, server: ScriptedServer, capsys: pytest.CaptureFixture[str]
):
    brain = server.brain

    def revoking(asked):
        if len(server.requests) == 3:
            server.personality.key = "another one"
        return brain(asked)

    server.brain = revoking
    status, result = find(glb, tmp_path, "--vlm", server.spec)
    said = capsys.readouterr().err
    assert (status, result["steps"]) == (2, 3)
    assert "answered 401" in said
    assert "HYPERNAV_API_KEY" in said
    assert "unavailable" not in said
    assert (tmp_path / "index.html").is_file()


def test_answers_of_no_use_are_counted_in_one_line(
    glb: Path, tmp_path: Path, server: ScriptedServer, capsys: pytest.CaptureFixture[str]
):
    server.brain = lambda asked: "I like trains"
    server.personality.honours = ()
    find(glb, tmp_path, "--vlm", server.spec, "--max-steps", "3")
    said = " ".join(capsys.readouterr().err.split())
    assert "no answer of the model could be used: 3 × no box in the answer" in said


@pytest.mark.slow
def test_an_exam_decides_who_is_asked_and_is_kept_in_the_results(
    glb: Path, tmp_path: Path, server: ScriptedServer
):
    exam = json.loads(write_exam(tmp_path).read_text()) | {"model": MODEL}
    (tmp_path / "exam.json").write_text(json.dumps(exam))
    who = ("--vlm", f"{server.spec}#{MODEL}", "--exam", tmp_path / "exam.json")
    status, result = find(glb, tmp_path / "run", *who, "--reasoner", "auto")
    assert (status, result["outcome"]) == (0, "found")
    assert result["parts"]["reasoner"] == "geometric"
    assert result["config"]["local"]["score_weights"] == [[1.0, 3.0]]
    assert result["config"]["presence"]["calibration"] == [[0.0, 0.1], [1.0, 0.9]]
