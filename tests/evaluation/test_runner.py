import pytest

from eval_runs import apart, record, spec
from hypernav.core.errors import CrashError, ModelUnavailableError, RunFolderError
from hypernav.evaluation.failures.classification import Failure
from hypernav.evaluation.runner import (
    NothingScoredError,
    RunHaltedError,
    RunProgress,
    check_scored,
    run_episodes,
)
from hypernav.evaluation.store.run_store import RunStore, read_records
from hypernav.evaluation.workers.worker_pool import Crashed, Done, Lost, Ready, Refused

EPISODES = [spec(str(k)) for k in range(6)]


class FakePool:
    """Workers that answer at once; what happens to the n-th episode sent can be told."""

    def __init__(self, surprises=None, *, answer=None, starts=None):
        self.surprises = surprises or {}
        self.answer = answer or (lambda episode: record(episode.episode_id))
        self.started, self.sent, self.closed = [], [], False
        self._starts = starts or {}
        self._reports = []

    def start(self, worker):
        self.started.append(worker)
        self._reports.append(self._starts.get(len(self.started), Ready)(worker))

    def send(self, worker, episode):
        self.sent.append(episode.episode_id)
        surprise = self.surprises.get(len(self.sent))
        if surprise is None:
            self._reports.append(Done(worker, self.answer(episode), 100.0 * worker))
        else:
            self._reports.append(surprise(worker))

    def wait(self, seconds):
        reports, self._reports = self._reports[:1], self._reports[1:]
        return reports

    def close(self):
        self.closed = True


def run(folder, pool, workers=2, watch=None):
    with RunStore(folder, {}) as store:
        return run_episodes(EPISODES, store, pool, workers=workers, watch=watch)


def ids(folder):
    return sorted(r.episode_id for r in read_records(folder))


def lost(worker):
    return Lost(worker, "killed by signal 9")


def test_every_episode_is_run_once_and_the_crew_dismissed(tmp_path):
    pool = FakePool()
    progress = run(tmp_path, pool)
    assert sorted(pool.sent) == ids(tmp_path) == list("012345")
    assert pool.closed
    assert (progress.done_now, progress.total, progress.peak_mb) == (6, 6, {0: 0.0, 1: 100.0})


def test_what_is_done_is_not_run_again(tmp_path):
    run(tmp_path, FakePool())
    again = FakePool()
    progress = run(tmp_path, again)
    assert again.started == again.sent == []
    assert (len(progress.records), progress.done_now) == (6, 0)


def test_no_more_workers_are_started_than_there_is_work_for(tmp_path):
    pool = FakePool()
    run(tmp_path, pool, workers=50)
    assert len(pool.started) == 6


def test_a_lost_worker_is_replaced_and_its_episode_repeated(tmp_path):
    pool = FakePool({2: lost})
    progress = run(tmp_path, pool)
    assert len(pool.sent) == 7
    assert len(pool.started) == 3
    assert progress.losses == 1
    assert ids(tmp_path) == list("012345")


def test_an_episode_that_kills_its_worker_again_and_again_is_a_simulator_error(tmp_path):
    pool = FakePool({1: lost, 2: lost, 3: lost})
    run(tmp_path, pool, workers=1)
    (broken,) = [r for r in read_records(tmp_path) if not r.counts]
    assert broken.why == "its worker was lost 3 times: killed by signal 9"
    assert ids(tmp_path) == list("012345")


def test_an_episode_is_not_blamed_for_a_worker_that_died_while_it_started(tmp_path):
    pool = FakePool(starts={k: lost for k in range(1, 5)})
    run(tmp_path, pool, workers=1)
    assert all(r.counts for r in read_records(tmp_path))


def test_workers_that_never_start_end_the_run(tmp_path):
    pool = FakePool(starts={k: lost for k in range(1, 100)})
    with pytest.raises(RunHaltedError, match="enough memory"):
        run(tmp_path, pool)
    assert pool.closed


def test_a_crash_leaves_its_episode_undone_and_the_others_go_on(tmp_path):
    pool = FakePool({3: lambda worker: Crashed(worker, "ZeroDivisionError: oops")})
    progress = run(tmp_path, pool)
    assert len(ids(tmp_path)) == 5
    assert list(progress.crashes.values()) == ["ZeroDivisionError: oops"]


def test_crash_after_crash_ends_the_run_and_keeps_the_tracebacks(tmp_path):
    trace = "Traceback:\n  line 3\nZeroDivisionError: oops\n"
    pool = FakePool({k: lambda worker: Crashed(worker, trace) for k in range(2, 9)})
    with pytest.raises(CrashError, match=r"3 episodes, .*: ZeroDivisionError: oops$") as caught:
        run(tmp_path, pool, workers=1)
    assert caught.value.details.count("line 3") == 3
    assert ids(tmp_path) == ["0"]


def test_a_crash_before_the_first_episode_ends_the_run(tmp_path):
    pool = FakePool(starts={1: lambda worker: Crashed(worker, "ImportError: no torch")})
    with pytest.raises(CrashError, match="no torch"):
        run(tmp_path, pool)


def test_what_a_worker_refuses_ends_the_run(tmp_path):
    pool = FakePool({2: lambda worker: Refused(worker, "the disk is full")})
    with pytest.raises(RunHaltedError, match="the disk is full"):
        run(tmp_path, pool)
    assert pool.closed


def test_a_model_that_stays_away_ends_the_run_and_nothing_is_counted(tmp_path):
    pool = FakePool(answer=lambda episode: apart(episode.episode_id))
    with pytest.raises(ModelUnavailableError, match="run the same command again"):
        run(tmp_path, pool, workers=1)
    assert len(pool.sent) == 3
    assert not any(r.counts for r in read_records(tmp_path))


def test_a_short_outage_does_not_end_the_run(tmp_path):
    def sometimes(episode):
        return (apart if int(episode.episode_id) % 2 else record)(episode.episode_id)

    run(tmp_path, FakePool(answer=sometimes), workers=1)
    assert len(ids(tmp_path)) == 6


def test_ctrl_c_keeps_what_is_done_and_dismisses_the_crew(tmp_path):
    def interrupt(progress):
        if progress.done_now == 3:
            raise KeyboardInterrupt

    pool = FakePool()
    with pytest.raises(KeyboardInterrupt):
        run(tmp_path, pool, workers=1, watch=interrupt)
    assert pool.closed
    assert len(ids(tmp_path)) == 3


def test_a_full_disk_dismisses_the_crew(tmp_path, monkeypatch):
    def full(path, line):
        raise RunFolderError("no space left on device")

    pool = FakePool()
    monkeypatch.setattr("hypernav.evaluation.store.record_file.append_line", full)
    with pytest.raises(RunFolderError, match="no space"):
        run(tmp_path, pool)
    assert pool.closed


def test_a_run_of_which_nothing_counts_has_no_result():
    away, broken = apart("0"), apart("1").model_copy(update={"failure": Failure.SIMULATOR_ERROR})
    check_scored(RunProgress([], 0))
    check_scored(RunProgress([record("0"), away, broken], 3))
    with pytest.raises(ModelUnavailableError, match="none of the 1 episodes"):
        check_scored(RunProgress([away], 1))
    with pytest.raises(NothingScoredError, match="none of the 2 episodes"):
        check_scored(RunProgress([away, broken], 2))
