"""Searches with a model server that is broken or evil, and the doctor's examination of it.

Most run in this process, for a search costs its least where everything is loaded already.
"""

import json
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

import pytest

from box_scenes import room_glb
from hostile.commands import Ended, check, run
from hostile.model_faults import FAULTS, LARGE, SLOW, Fault
from hostile.preloaded import Request
from hypernav.app.cli.main import main
from hypernav.core.chat import Question
from hypernav.core.errors import ModelSetupError, ModelUnavailableError
from hypernav.search.models.chat.config import ChatConfig
from hypernav.search.models.chat.server.openai_chat import OpenAiChat
from servers.faulty import FaultyServer

pytestmark = pytest.mark.slow

PATIENCE_S = 0.4
GRACE_S = 1.0
WAITS = ("chat.first_wait_s=0.05", "chat.longest_wait_s=0.1")
SMALL = ("embodiment.camera.width=64", "embodiment.camera.height=48")
HURTFUL = set("\x00\x1b\x9b\u202e")


@pytest.fixture(scope="module")
def glb(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A room, in which a search without a model has loaded all that a search needs."""
    folder = tmp_path_factory.mktemp("scene")
    glb = room_glb(folder / "room.glb")
    with pytest.raises(SystemExit):
        main(["find", "bed", "--scene", str(glb), "--out", str(folder), "--max-steps", "2"])
    return glb


def serving(fault: Fault) -> FaultyServer:
    return FaultyServer(fault.act, models=fault.models, other=fault.other)


def patience(fault: Fault) -> tuple[str, ...]:
    """Options for a short patience where no answer comes, and a long one where one does."""
    seconds = PATIENCE_S if fault.status == 3 else 5.0
    return (f"chat.patience_s={seconds}", f"chat.timeout_s={seconds}", *WAITS)


def search(server: FaultyServer, fault: Fault, glb: Path, out: Path) -> list[str]:
    """The command line of a short search."""
    place = ("--scene", str(glb), "--start", "1", "2", "180", "--out", str(out))
    model = ("--vlm", f"openai:{server.url}", "--max-steps", "2")
    return ["find", "bed", *place, *model, "--set", *patience(fault), *SMALL]


def run_here(arguments: Sequence[str], capsys: pytest.CaptureFixture[str]) -> Ended:
    """Run a command in this process, and measure what it takes beyond what is loaded."""
    Path("/proc/self/clear_refs").write_text("5")  # forgets the peak of memory
    before, begin = peak_mb(), time.monotonic()
    with pytest.raises(SystemExit) as stop:
        main(arguments)
    seconds, said = time.monotonic() - begin, capsys.readouterr()
    status = stop.value.code
    request = Request(list(arguments), "")
    assert isinstance(status, int)
    return Ended(request, status, said.out, said.err, seconds, peak_mb() - before)


def peak_mb() -> float:
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) / 1024 for line in lines if line.startswith("VmHWM"))


def check_files(fault: Fault, out: Path) -> None:
    """Whatever happened, result and page are there and can be looked at."""
    result = json.loads((out / "result.json").read_text())
    assert (result["outcome"] == "model_unavailable") == (fault.status != 1)
    assert result["ledger"]["total"]["tokens_in"] < 100_000
    page = (out / "index.html").read_text()
    assert not set(page) & HURTFUL
    assert "<script>alert" not in page


def test_there_are_many_faults_and_none_twice():
    assert len({fault.name for fault in FAULTS}) == len(FAULTS) > 150


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_a_search_ends_well_and_leaves_what_it_did(
    fault: Fault, glb: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    with serving(fault) as server:
        ended = run_here(search(server, fault, glb, tmp_path), capsys)
    check(ended, fault.status, *fault.words)
    assert (fault.status == 1) != ended.err.splitlines()[-1].startswith("hypernav: ")
    check_files(fault, tmp_path)


@pytest.mark.parametrize("fault", [SLOW[0], SLOW[4], *LARGE[:10:3]], ids=lambda fault: fault.name)
def test_a_process_of_its_own_ends_in_the_same_way(fault: Fault, glb: Path, tmp_path: Path):
    with serving(fault) as server:
        ended = run(search(server, fault, glb, tmp_path / "out"), tmp_path)
    check(ended, fault.status, *fault.words)
    check_files(fault, tmp_path / "out")


@pytest.mark.parametrize("fault", [*SLOW, *LARGE], ids=lambda fault: fault.name)
def test_a_question_takes_no_longer_than_its_patience(fault: Fault):
    config = ChatConfig(timeout_s=0.3, patience_s=PATIENCE_S, first_wait_s=0.05)
    with serving(fault) as server:
        begin = time.monotonic()
        with suppress(ModelUnavailableError, ModelSetupError):
            OpenAiChat(server.url, config=config, environment={}).ask(Question("x", "A bed?"))
        assert time.monotonic() - begin < PATIENCE_S + GRACE_S


@pytest.mark.parametrize("fault", FAULTS, ids=lambda fault: fault.name)
def test_the_doctor_ends_in_time_and_finds_the_fault(
    fault: Fault, capsys: pytest.CaptureFixture[str]
):
    with serving(fault) as server:
        options = ("--vlm", f"openai:{server.url}", "--set", *patience(fault))
        ended = run_here(["doctor", *options], capsys)
    check(ended, 1, "FAULT", "what to change")
