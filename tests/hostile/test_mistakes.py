"""Mistakes of a stranger, by accident or not: each is one line and status 2, soon."""

import pytest

from eval_runs import write_room
from hostile.commands import check, run
from hypernav.app.warmup.background import FIRST_RUN

pytestmark = pytest.mark.slow

FIND = ("find", "bed", "--scene", "room.glb")
EVAL = ("eval", "scene:room.glb")
LONG = "x" * 5000
EMPTY_OPTIONS = {
    FIND: "agent vlm detector reasoner segmenter similarity record config set scene out max-steps "
    "seed preset",
    EVAL: "agent vlm detector reasoner segmenter similarity config set out episodes scenes goals "
    "scenes-dir workers ray save max-steps success-distance seed",
    ("ablate", "scene:room.glb"): "of study only out vlm set",
    ("exam",): "vlm detector reasoner segmenter config compare set out size bank at-once preset",
}
CONTROLS = [chr(code) for code in (*range(1, 32), *range(127, 160))]

COMMANDS = [
    [], ["fnd", "bed"], ["Find", "bed"], ["FIND"], ["evla"], ["reprot"], ["docter"], ["house"],
    ["-"], ["--"], ["--verison"], ["-v"], ["--quiet"], ["find"], ["find", "--quiet"],
    ["find", "bed", "sofa"], ["eval"], ["eval", "--quiet"], ["doctor"],
    ["houses"], ["houses", "shwo", "3"], ["houses", "export"], ["report", "--compare"], [LONG],
    ["\x1b[31mfind"], ["find\udcff"], ["find bed"], ["/bin/sh"], ["$(reboot)"],
]  # fmt: skip
GOALS = [
    *["", " ", "\u3000", "a" * 501, "bed " * 2500, "\ud83d", "bed\udcff", "\udc80\udc81"],
    *CONTROLS,
]
TYPOS = [
    [*command, *typo]
    for command in (FIND, EVAL)
    for typo in (
        ["--agnt", "frontier"], ["--agent", "frontiers"], ["--agent", "nope:Nope"],
        ["--agent", ":"], ["--agent", "os:nope"], ["--agent", "a b"], ["--agent", LONG],
        ["--agent", "nope."],
        ["--preset", "papre"], ["--vlm", "gpt"], ["--vlm", "openai:"], ["--vlm", "openai:ftp://x"],
        ["--vlm", "http://x"], ["--vlm", "openai:x:80"], ["--vlm", "local:"],
        ["--vlm", "replay:no"], ["--vlm", LONG], ["--detector", "yolo"],
        ["--detector", "yolox:"], ["--detector", "vlm"],
        ["--detector", "yolox:no.onnx"], ["--reasoner", "geo"], ["--reasoner", "vlm"],
        ["--segmenter", "sam"], ["--segmenter", "onnx-sam:a"], ["--segmenter", "onnx-sam:a,b"],
        ["--similarity", "clip"], ["--similarity", "local:"], ["--similarity", "local:a,b"],
        ["--config", "no.yaml"], ["--config", "."], ["--config", "room.glb"],
        ["--set", "search"], ["--set", "=1"], ["--set", "search=1"], ["--set", "a.b=1"],
        ["--set", "search.endurence_steps=3"], ["--set", "search.endurance_steps=many"],
        ["--set", "search.endurance_steps=["], ["--set", "..=1"], ["--set", "search..a=1"],
        ["--set", "search.endurance_steps.more=1"], ["--set", "world.cell_m=1e-6"],
        ["--set", "grounding.family=foo"], ["--set", "chat.dialect=foo"], ["--set", f"{LONG}=1"],
        ["--set", "mapping.clearance_m=1"], ["--set", "world.actions.forward_m=1"],
        ["--max-steps", "0"], ["--max-steps", "-1"], ["--max-steps", "ten"], ["--max-steps", "nan"],
        ["--max-steps", "1e3"], ["--max-steps", "9" * 5000],
        ["--set", "grounding.prompt='{goal!r:>99999999999}'"], ["--config", "/proc/self/cmdline"],
        ["--seed", "-1"], ["--seed", "1.5"], ["--seed", "0x10"],
        ["--quiet", "no"], ["--out"], ["--help-me"],
    )
]  # fmt: skip
FIND_ONLY = [
    [*FIND[:2], *rest]
    for rest in (
        ["--scene", "no.glb"], ["--scene", LONG], ["--scene", "houses:"], ["--scene", "houses:-1"],
        ["--scene", "houses:1e3"], ["--scene", "houses:1.5"], ["--scene", "houses:" + "9" * 50],
        ["--scene", "house:3"], ["--scene", "."], ["--scene", "/"], ["--scene", "tired.py"],
        ["--scene", "\x1b]0;title\x07.glb"], ["--scene", "a\udcff.glb"], ["--scene", "builtin:2"],
        ["--start", "1", "2"], ["--start", "a", "b", "c"], ["--start", "1", "2", "3", "4"],
    )
]  # fmt: skip
EVAL_ONLY = [
    ["eval", *rest]
    for rest in (
        ["houses-vall"], ["houses-val#"], ["houses-val#1:2"], ["houses-train#5:1"], ["#"], [":"],
        ["houses-train#a:b"], ["habitat:"], ["habitat:no.json.gz"], ["habitat:room.glb"],
        ["habitat:room.glb#3"], ["scene:"], ["scene:no.glb"], ["scene:room.glb#0"],
        ["scene:room.glb#-1"], ["scene:room.glb#x"], [LONG], [f"scene:{LONG}"], ["\x1b[2J"],
        [*EVAL[1:], "--episodes", "5"], [*EVAL[1:], "--episodes", "a:b"],
        [*EVAL[1:], "--episodes", "5:2"], [*EVAL[1:], "--episodes", "-1:2"],
        [*EVAL[1:], "--episodes", "900:901"], [*EVAL[1:], "--scenes", "rom"],
        [*EVAL[1:], "--scenes", "7"], [*EVAL[1:], "--goals", "unicorn"],
        [*EVAL[1:], "--goals", ","],
        [*EVAL[1:], "--workers", "0"], [*EVAL[1:], "--workers", "-2"],
        [*EVAL[1:], "--workers", "two"],
        [*EVAL[1:], "--save", "all"], [*EVAL[1:], "--success-distance", "0"],
        [*EVAL[1:], "--success-distance", "-1"], [*EVAL[1:], "--record", "x.jsonl"],
        [*EVAL[1:], "--start", "1", "2", "3"],
    )
]  # fmt: skip
ABLATE = [
    ["ablate", *rest]
    for rest in (
        [], ["houses-vall"], [*EVAL[1:], "--only", "no-erosoin"], [*EVAL[1:], "--only", ","],
        [*EVAL[1:], "--only", LONG], [*EVAL[1:], "--of", "both"], [*EVAL[1:], "--preset", "paper"],
        [*EVAL[1:], "--study", "all"], [*EVAL[1:], "--agent", "nope:Nope"],
        [*EVAL[1:], "--set", "search.looks=never"], [*EVAL[1:], "--workers", "0"],
        [*EVAL[1:], "--record", "x.jsonl"], [*EVAL[1:], "--goals", "unicorn"],
    )
]  # fmt: skip
OTHERS = [
    ["report", "no"], ["report", "room.glb"], ["report", "."], ["report", ".", "--compare"],
    ["report", LONG], ["report", "/dev/null"], ["report", "/proc"], ["report", "a\udcff"],
    ["doctor", "--vlm", "gpt"], ["doctor", "--vlm", "replay:x"],
    ["doctor", "--vlm", "openai:ftp://x"], ["doctor", "--vlm", "openai:"],
    ["doctor", "--vlm", ""], ["doctor", "--vlm", LONG],
    *[["houses", what, number] for what in ("show", "export") for number in (
        "abc", "-1", "1.5", "1e3", "", " ", "9" * 10, "9" * 5000, "houses:", "٣", "3 4",
    )],
    *[["houses", "episodes", *rest, "--out", "a.json"] for rest in (
        ["houses-vall"], ["houses-train", "--houses", "5"], ["houses-train", "--houses", "5:1"],
        ["houses-train", "--houses", "a:b"], ["houses-train", "--houses", "-1:3"],
        ["houses-train", "--houses", "1:2:3"], ["houses-train", "--count", "many"], [""],
    )],
    ["houses", "episodes", "houses-train"],
    ["robot", "replay", "no"], ["robot", "replay", LONG], ["robot", "replay", "/dev/null"],
    ["houses", "episodes", "houses-train", "--out", "a.txt"],
]  # fmt: skip
EMPTY = [
    [*command, *given]
    for command, names in EMPTY_OPTIONS.items()
    for name in names.split()
    for given in ([f"--{name}", ""], [f"--{name}="])
]
MISTAKES = [
    *COMMANDS, *([*FIND[:1], goal, *FIND[2:]] for goal in GOALS), *TYPOS, *FIND_ONLY, *EVAL_ONLY,
    *ABLATE, *OTHERS, *EMPTY,
]  # fmt: skip


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("mistakes")
    write_room(folder / "room.glb")
    return folder


def test_they_are_many():
    assert len(MISTAKES) > 300


@pytest.mark.parametrize("arguments", MISTAKES, ids=range(len(MISTAKES)))
def test_a_mistake_is_one_line(arguments, folder):
    ended = run(arguments, folder)
    check(ended, 2, "hypernav: ")
    said = ended.err.removeprefix(f"{FIRST_RUN}\n")
    assert said.count("\n") == 1
    assert len(said) < 2000
    assert not ended.out
    assert sorted(path.name for path in folder.iterdir()) == ["room.glb"]


def test_all_choices_are_named(folder):
    for value in ("grounding.family=foo", "chat.dialect=foo"):
        check(run([*FIND, "--set", value], folder), 2, "'auto'", " or ", "'foo'")


def test_a_url_of_another_kind_is_not_advised(folder):
    ended = run([*FIND, "--vlm", "openai:ftp://x"], folder)
    check(ended, 2, "ftp://", "write openai:http://x")
    assert "http://ftp" not in ended.err
