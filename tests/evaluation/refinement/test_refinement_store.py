from dataclasses import replace

import pytest

from hypernav.core.errors import RunFolderError
from hypernav.core.geometry.transforms import Pose2
from hypernav.evaluation.refinement.area_record import AreaRecord, BoxSource, MaskSource
from hypernav.evaluation.refinement.goal_position import GoalPosition
from hypernav.evaluation.refinement.store import LINES_FILE, RefinementStore
from small_episodes import episode_from

EPISODE = episode_from(Pose2(0.0, 0.0, 0.0))
AT = GoalPosition(in_obstacle=False, unreachable=False, occluded=True, fails=True)
RECORD = replace(AreaRecord.begun(EPISODE, BoxSource.TRUE, MaskSource.RAW), position=AT)


def written(folder):
    with RefinementStore(folder, {"seed": 0}) as store:
        store.add(EPISODE, [RECORD])
        store.add(replace(EPISODE, episode_id="1"), [])
    return folder


def test_a_study_goes_on_from_its_lines(tmp_path):
    with RefinementStore(written(tmp_path), {"seed": 0}) as store:
        assert set(store.done) == {("tests", "0"), ("tests", "1")}
        assert store.records == [RECORD]


def test_a_line_that_was_cut_off_is_written_again(tmp_path):
    path = written(tmp_path) / LINES_FILE
    path.write_bytes(path.read_bytes()[:-5])
    with RefinementStore(tmp_path, {"seed": 0}) as store:
        assert set(store.done) == {("tests", "0")}
        store.add(replace(EPISODE, episode_id="1"), [])
    with RefinementStore(tmp_path, {"seed": 0}) as store:
        assert len(store.done) == 2


def test_another_configuration_is_refused(tmp_path):
    with pytest.raises(RunFolderError, match="seed was 0, is now 1"):
        RefinementStore(written(tmp_path), {"seed": 1}).__enter__()


def test_a_damaged_line_is_refused(tmp_path):
    path = written(tmp_path) / LINES_FILE
    path.write_bytes(b"nonsense\n" + path.read_bytes())
    with pytest.raises(RunFolderError, match="damaged"):
        RefinementStore(tmp_path, {"seed": 0}).__enter__()
