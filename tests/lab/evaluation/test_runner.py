from dataclasses import replace

import pytest

from eval_runs import apart, record, spec
from hypernav.core.errors import CrashError, ModelUnavailableError, RunFolderError
from hypernav.lab.evaluation.failures import Failure
from hypernav.lab.evaluation.runner import (
    NothingScoredError,
    RunHaltedError,
    RunProgress,
    begin_again,
    check_scored,
    run_episodes,
)
from hypernav.lab.evaluation.store.run_store import RunStore, read_records
from hypernav.lab.evaluation.workers.worker_pool import Crashed, Done, Lost, Ready, Refused

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

    def send(self, worker, life):
        self.sent.append(life.key[1])
        surprise = self.surprises.get(len(self.sent))
        if surprise is None:
            records = [self.answer(episode) for episode in life.episodes]
            self._reports.append(Done(worker, records, 100.0 * worker))
        else:
            self._reports.append(surprise(worker))

    def wait(self, seconds):
        reports, self._reports = self._reports[:1], self._reports[1:]
        return reports

    def close(self):
        self.closed = True


def run(folder, pool, workers=2, watch=None, episodes=EPISODES):
    with RunStore(folder, {}) as store:
        begin_again(episodes, store)
        return run_episodes(episodes, store, pool, workers=workers, watch=watch)


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


def test_a_record_of_an_episode_that_the_run_lacks_is_refused(tmp_path):
    with RunStore(tmp_path, {}) as store:
        store.add(record("99"))
    with pytest.raises(RunFolderError, match=r"1 episodes that this data set does not have.*99"):
        run(tmp_path, FakePool())


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
    assert [r.counts for r in read_records(tmp_path)] == [True] * 6


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
    monkeypatch.setattr("hypernav.lab.evaluation.store.record_file.append_line", full)
    with pytest.raises(RunFolderError, match="no space"):
        run(tmp_path, pool)
    assert pool.closed


LIVES = [
    replace(spec(f"{life}.{goal}"), life=life) for goal in range(1, 4) for life in ("first", "last")
]
"""Two lives of three goals, mixed."""


def test_the_goals_of_a_life_go_to_one_worker_in_their_order(tmp_path):
    pool = FakePool()
    progress = run(tmp_path, pool, episodes=LIVES)
    assert pool.sent == ["first", "last"]
    assert [r.episode_id for r in progress.records] == [
        *("first.1", "first.2", "first.3"),
        *("last.1", "last.2", "last.3"),
    ]


def test_a_life_that_was_cut_short_runs_again_from_its_first_goal(tmp_path):
    run(tmp_path, FakePool(), episodes=LIVES)
    path = tmp_path / "episodes.jsonl"
    path.write_text("".join(path.read_text().splitlines(keepends=True)[:5]))  # killed before last.3
    again = FakePool()
    run(tmp_path, again, episodes=LIVES)
    assert again.sent == ["last"]
    assert ids(tmp_path) == sorted(one.episode_id for one in LIVES)


def test_a_life_with_a_goal_that_does_not_count_runs_again(tmp_path):
    def away_at_the_end(episode):
        return (apart if episode.episode_id == "last.3" else record)(episode.episode_id)

    run(tmp_path, FakePool(answer=away_at_the_end), episodes=LIVES)
    again = FakePool()
    run(tmp_path, again, episodes=LIVES)
    assert again.sent == ["last"]
    assert all(r.counts for r in read_records(tmp_path))


def test_a_life_that_is_given_up_has_a_record_for_every_goal(tmp_path):
    run(tmp_path, FakePool({1: lost, 2: lost, 3: lost}), workers=1, episodes=LIVES)
    records = [r for r in read_records(tmp_path) if not r.counts]
    assert [(r.life, r.goal_number) for r in records] == [("first", k) for k in (1, 2, 3)]


def test_the_outage_of_one_life_is_one_outage(tmp_path):
    def first_away(episode):
        return (apart if episode.life == "first" else record)(episode.episode_id)

    run(tmp_path, FakePool(answer=first_away), workers=1, episodes=LIVES)
    assert len(ids(tmp_path)) == 6


def test_a_run_of_which_nothing_counts_has_no_result():
    away, broken = apart("0"), apart("1").model_copy(update={"failure": Failure.SIMULATOR_ERROR})
    check_scored(RunProgress([], 0))
    check_scored(RunProgress([record("0"), away, broken], 3))
    with pytest.raises(ModelUnavailableError, match="none of the 1 episodes"):
        check_scored(RunProgress([away], 1))
    with pytest.raises(NothingScoredError, match="none of the 2 episodes"):
        check_scored(RunProgress([away, broken], 2))
