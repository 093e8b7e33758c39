from pathlib import Path

import pytest

from hypernav.cli.main import main


def test_an_exam_of_nobody_says_whom_it_may_examine(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
):
    with pytest.raises(SystemExit) as stop:
        main(["exam", "--out", str(tmp_path / "exam")])
    assert stop.value.code == 2
    assert "--vlm openai:" in capsys.readouterr().err
    assert not (tmp_path / "exam").exists()
