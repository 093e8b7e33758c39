import dataclasses
from codecs import BOM_UTF8
from pathlib import Path

import pytest

from chat_models import Parrot, image
from hypernav.core.chat import Question
from hypernav.core.errors import ModelUnavailableError, RecordingError
from hypernav.search.models.chat.recording import RecordingChat, ReplayChat

BED = Question("ground", "Locate every bed", (image(),))
WHICH = Question("choose block", "Which numbered block?", (image(1),), ("3", "7"))


def record(path: Path, parrot: Parrot, *questions: Question) -> list:
    recorder = RecordingChat(parrot, path)
    answers = [recorder.ask(question) for question in questions]
    recorder.close()
    return answers


def test_a_replay_gives_the_same_answers_in_full(tmp_path: Path):
    path = tmp_path / "run" / "r.jsonl"
    parrot = Parrot("[]", "7", "I'm sorry, I can't.", "neither", "é\n\u2028 \ud83d\ude00", "3")
    asked = [BED, WHICH, WHICH, WHICH, BED, WHICH]
    answers = record(path, parrot, *asked)
    replay = ReplayChat(path)
    assert replay.identify() == parrot.identify()
    for question, answer in zip(asked, answers, strict=True):
        assert dataclasses.asdict(replay.ask(question)) == dataclasses.asdict(answer)


def test_an_editor_may_put_a_byte_order_mark_before_it(tmp_path: Path):
    path = tmp_path / "r.jsonl"
    record(path, Parrot("7"), WHICH)
    path.write_bytes(BOM_UTF8 + path.read_bytes())
    assert ReplayChat(path).ask(WHICH).value == "7"


def test_recording_twice_gives_the_same_bytes(tmp_path: Path):
    for name in ("a", "b"):
        record(tmp_path / name, Parrot("7"), WHICH, WHICH)
    assert (tmp_path / "a").read_bytes() == (tmp_path / "b").read_bytes()


def test_every_exchange_is_on_disk_at_once(tmp_path: Path):
    recorder = RecordingChat(Parrot("7"), tmp_path / "r.jsonl")
    for count in range(1, 4):
        recorder.ask(WHICH)
        assert len((tmp_path / "r.jsonl").read_text().splitlines()) == count + 1
    recorder.close()


def test_an_outage_is_replayed_as_one(tmp_path: Path):
    recorder = RecordingChat(Parrot("7", ModelUnavailableError("gone")), tmp_path / "r.jsonl")
    recorder.ask(WHICH)
    with pytest.raises(ModelUnavailableError):
        recorder.ask(WHICH)
    recorder.close()
    replay = ReplayChat(tmp_path / "r.jsonl")
    assert replay.ask(WHICH).value == "7"
    with pytest.raises(ModelUnavailableError, match="gone"):
        replay.ask(WHICH)


@pytest.mark.parametrize(
    ("change", "difference"),
    [
        ({"text": "Locate every sofa"}, "differs in text"),
        ({"images": (image(9),)}, "differs in images"),
        ({"max_tokens": 5}, "differs in max_tokens"),
        ({"kind": "verify"}, "differs in kind"),
    ],
)
def test_a_question_that_was_not_recorded_shows_the_nearest(
    tmp_path: Path, change: dict, difference: str
):
    record(tmp_path / "r.jsonl", Parrot("[]"), BED, WHICH)
    with pytest.raises(RecordingError, match=difference) as caught:
        ReplayChat(tmp_path / "r.jsonl").ask(dataclasses.replace(BED, **change))
    assert "Nearest: 'Locate every bed'" in str(caught.value)


def test_a_single_pixel_makes_another_question(tmp_path: Path):
    record(tmp_path / "r.jsonl", Parrot("[]"), BED)
    other = image()
    other[0, 0, 0] ^= 1
    with pytest.raises(RecordingError, match="images"):
        ReplayChat(tmp_path / "r.jsonl").ask(dataclasses.replace(BED, images=(other,)))


def test_asking_more_often_than_recorded(tmp_path: Path):
    record(tmp_path / "r.jsonl", Parrot("[]"), BED)
    replay = ReplayChat(tmp_path / "r.jsonl")
    replay.ask(BED)
    with pytest.raises(RecordingError, match="1 times in the recording"):
        replay.ask(BED)


def test_an_existing_recording_is_never_overwritten(tmp_path: Path):
    record(tmp_path / "r.jsonl", Parrot("[]"), BED)
    with pytest.raises(RecordingError, match="exists already"):
        RecordingChat(Parrot("[]"), tmp_path / "r.jsonl")


def test_a_place_that_cannot_be_written(tmp_path: Path):
    (tmp_path / "file").write_text("")
    with pytest.raises(RecordingError, match="cannot record"):
        RecordingChat(Parrot("[]"), tmp_path / "file" / "r.jsonl")


@pytest.mark.parametrize(
    ("content", "hint"),
    [
        (b"", "empty"),
        (b"hello\n", "line 1"),
        (b'{"format": "hypernav-recording", "version": 2, "model": "m"}\n', "line 1"),
        (b'{"format": "hypernav-recording", "version": 1, "model": "m"}\n{"question":', "line 2"),
        (b"\xff\xfe\x00", "cannot read"),
    ],
)
def test_a_broken_recording(tmp_path: Path, content: bytes, hint: str):
    (tmp_path / "r.jsonl").write_bytes(content)
    with pytest.raises(RecordingError, match=hint):
        ReplayChat(tmp_path / "r.jsonl")


def test_a_missing_recording(tmp_path: Path):
    with pytest.raises(RecordingError, match="cannot read"):
        ReplayChat(tmp_path / "none.jsonl")
