"""Any kind of record keeps the promises of the file: what a refinement study writes, too."""

import pytest
from pydantic import ValidationError

from eval_runs import record
from hypernav.core.errors import RunFolderError
from hypernav.core.geometry.transforms import Pose2
from hypernav.lab.evaluation.record import EpisodeRecord
from hypernav.lab.evaluation.refinement.area_record import (
    AreaRecord,
    BoxSource,
    EpisodeAreas,
    MaskSource,
)
from hypernav.lab.evaluation.store.record_file import RecordFile
from small_episodes import episode_from

AREA = AreaRecord.begun(episode_from(Pose2(0.0, 0.0, 0.0)), BoxSource.TRUE, MaskSource.RAW)
FIRST = EpisodeAreas(scene_id="tests", episode_id="0", areas=(AREA,))
SECOND = EpisodeAreas(scene_id="tests", episode_id="1", areas=())


def written(folder):
    path = folder / "episodes.jsonl"
    file = RecordFile(path, EpisodeAreas)
    file.add(FIRST)
    file.add(SECOND)
    return path


def test_records_are_read_back_as_they_were(tmp_path):
    assert list(RecordFile(written(tmp_path), EpisodeAreas).records.values()) == [FIRST, SECOND]


def test_a_line_that_was_cut_off_is_written_again(tmp_path):
    path = written(tmp_path)
    path.write_bytes(path.read_bytes()[:-5])
    file = RecordFile(path, EpisodeAreas)
    assert set(file.records) == {FIRST.key}
    file.add(SECOND)
    assert len(RecordFile(path, EpisodeAreas).records) == 2


def test_an_episode_is_there_only_once(tmp_path):
    file = RecordFile(written(tmp_path), EpisodeAreas)
    with pytest.raises(RunFolderError, match="tests/0 is done already"):
        file.add(FIRST)


@pytest.mark.parametrize("steps", [-1, 10**400])
def test_an_impossible_count_is_refused(steps):
    values = record("0").model_dump() | {"steps": steps}
    with pytest.raises(ValidationError, match="steps"):
        EpisodeRecord.model_validate(values)


def test_a_damaged_line_is_refused(tmp_path):
    path = written(tmp_path)
    path.write_bytes(b"nonsense\n" + path.read_bytes())
    with pytest.raises(RunFolderError, match="line 1 is damaged"):
        RecordFile(path, EpisodeAreas)
