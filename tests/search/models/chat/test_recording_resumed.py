"""A search that is repeated asks nothing twice, and goes on asking where its recording ends."""

from pathlib import Path

import pytest

from chat_models import Parrot, image
from hypernav.core.chat import Question
from hypernav.core.errors import ModelUnavailableError, RecordingError
from hypernav.search.models.chat.recording import ResumingChat

FIRST = Question("choose block", "Which numbered block?", (image(1),), ("3", "7"))
OTHER = Question("choose block", "Which block now?", (image(2),), ("3", "7"))


def asked(path: Path, parrot: Parrot, *questions: Question) -> list[str]:
    chat = ResumingChat(parrot, path)
    answers = [chat.ask(question).text for question in questions]
    chat.close()
    return answers


def test_recorded_answers_come_first_and_the_model_after_them(tmp_path):
    path = tmp_path / "search" / "model.jsonl"
    assert asked(path, Parrot("3", "7"), FIRST, FIRST) == ["3", "7"]
    assert asked(path, Parrot("3"), FIRST, FIRST, OTHER, FIRST) == ["3", "7", "3", "3"]
    nobody = Parrot(ModelUnavailableError("nobody is there"))
    assert asked(path, nobody, FIRST, FIRST, OTHER, FIRST) == ["3", "7", "3", "3"]


def test_a_recording_cut_anywhere_is_gone_on_with(tmp_path):
    path = tmp_path / "whole"
    asked(path, Parrot("3", "7"), FIRST, OTHER)
    whole = path.read_bytes()
    for size in range(0, len(whole), 7):
        part = tmp_path / str(size)
        part.write_bytes(whole[:size])
        assert set(asked(part, Parrot("3"), FIRST, OTHER)) <= {"3", "7"}
        assert len(part.read_text().splitlines()) == 3


def test_an_outage_that_was_recorded_comes_again(tmp_path):
    path = tmp_path / "model.jsonl"
    for parrot in (Parrot(ModelUnavailableError("gone")), Parrot("3")):
        chat = ResumingChat(parrot, path)
        with pytest.raises(ModelUnavailableError, match="gone"):
            chat.ask(FIRST)
        chat.close()


def test_the_recording_knows_the_name_of_its_model(tmp_path):
    path = tmp_path / "model.jsonl"
    chat = ResumingChat(Parrot("3"), path)
    name = chat.identify()
    chat.ask(FIRST)
    chat.close()
    again = ResumingChat(Parrot("3"), path)
    assert again.identify() == name
    again.close()


def test_nothing_is_cut_or_written_outside_of_its_folder(tmp_path):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.write_text("a line\nhalf a line")
    (tmp_path / "symbolic").symlink_to(elsewhere)
    (tmp_path / "hard").hardlink_to(elsewhere)
    for name in ("symbolic", "hard"):
        with pytest.raises(RecordingError, match="link"):
            ResumingChat(Parrot("3"), tmp_path / name)
    assert elsewhere.read_text() == "a line\nhalf a line"


def test_damage_is_an_error(tmp_path):
    path = tmp_path / "model.jsonl"
    path.write_text("no recording\n")
    with pytest.raises(RecordingError, match="line 1"):
        ResumingChat(Parrot("3"), path)
