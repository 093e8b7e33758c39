import os
import signal

import pytest

from eval_runs import timeless_lines, write_room
from hypernav.core.embodiment import Action
from hypernav.lab.evaluation.evaluate import evaluate
from hypernav.lab.evaluation.report.report_page import write_report
from hypernav.lab.evaluation.report.run_data import load_runs
from hypernav.lab.evaluation.run_plan import RunPlan, Selection
from hypernav.lab.evaluation.runner import ATTEMPTS, NothingScoredError, check_scored
from small_worlds import small_config


class Quitter:
    """Stops at once."""

    def reset(self, goal):
        pass

    def act(self, observation):
        return Action.STOP


class Buggy(Quitter):
    def act(self, observation):
        raise ZeroDivisionError("a bug of one's own")


class Deadly(Quitter):
    def act(self, observation):
        os.kill(os.getpid(), signal.SIGKILL)
        return super().act(observation)


def plan(tmp_path):
    room = write_room(tmp_path / "room.glb")
    return RunPlan(f"scene:{room}#1", Selection(goals="bed"), config=small_config())


@pytest.mark.slow
def test_an_agent_of_ones_own_gets_a_run_and_a_report(tmp_path):
    progress = evaluate(plan(tmp_path), tmp_path / "run", Quitter)
    assert (progress.done_now, progress.records[0].steps) == (1, 1)
    assert evaluate(plan(tmp_path), tmp_path / "run", Quitter).done_now == 0
    page = write_report(tmp_path / "run", load_runs([tmp_path / "run"])).read_text()
    assert "Quitter" in page
    assert "ground-truth detection" not in page


@pytest.mark.slow
def test_a_bug_in_an_agent_is_no_result_and_its_traceback_is_kept(tmp_path):
    progress = evaluate(plan(tmp_path), tmp_path / "run", Buggy)
    assert progress.records == []
    ((life, error),) = progress.crashes.items()
    assert [episode.goal.text for episode in life.episodes] == ["bed"]
    assert "a bug of one's own" in error
    # The bug is mended: the episode that has no result is run.
    assert evaluate(plan(tmp_path), tmp_path / "again", Quitter).done_now == 1
    assert len(timeless_lines(tmp_path / "again")) == 1


@pytest.mark.slow
def test_a_run_that_lost_the_workers_of_all_its_episodes_has_no_result(tmp_path):
    progress = evaluate(plan(tmp_path), tmp_path / "run", Deadly)
    assert progress.losses == ATTEMPTS
    with pytest.raises(NothingScoredError, match=f"its worker was lost {ATTEMPTS} times: killed"):
        check_scored(progress)
