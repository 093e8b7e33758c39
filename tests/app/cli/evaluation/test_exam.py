from pathlib import Path

import pytest

from hypernav.app.cli.main import main


def test_an_exam_of_nobody_says_whom_it_may_examine(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    with pytest.raises(SystemExit) as stop:
        main(["exam", "--out", str(tmp_path / "exam")])
    assert stop.value.code == 2
    assert "--vlm openai:" in capsys.readouterr().err
    assert not (tmp_path / "exam").exists()


def test_a_detector_without_its_file_is_refused_before_a_building_is_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
):
    monkeypatch.setattr(
        "hypernav.app.cli.evaluation.exam.sit", lambda *_, **__: pytest.fail("it has begun")
    )
    with pytest.raises(SystemExit) as stop:
        main(["exam", "--detector", "yolox:no.onnx", "--out", str(tmp_path / "exam")])
    assert stop.value.code == 2
    assert "no.onnx" in capsys.readouterr().err
