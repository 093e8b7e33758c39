import json
import multiprocessing
import os
import subprocess
import sys
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from eval_runs import apart, record
from hypernav.core.errors import RunFolderError
from hypernav.lab.evaluation.record import EpisodeRecord
from hypernav.lab.evaluation.store.run_store import (
    EPISODES_FILE,
    UNENDED,
    RunStore,
    Session,
    differences,
    read_configuration,
    read_records,
    read_sessions,
)
from leads import lead

CONFIGURATION = {"agent": "hypernav", "config": {"search": {"endurance_steps": 40}}}


def store(folder, configuration=CONFIGURATION):
    return RunStore(folder, configuration)


def filled(folder, count=3):
    with store(folder) as run:
        for number in range(count):
            run.add(record(str(number)))
    return folder / EPISODES_FILE


def test_what_is_added_is_read_back_as_it_was(tmp_path):
    filled(tmp_path)
    assert read_records(tmp_path) == [record(str(number)) for number in range(3)]
    with store(tmp_path) as run:
        assert list(run.records) == [("house", "0"), ("house", "1"), ("house", "2")]


def test_infinite_lengths_survive(tmp_path):
    with store(tmp_path) as run:
        run.add(record(distance_to_goal_m=float("inf"), shortest_path_m=float("inf")))
    line = json.loads((tmp_path / EPISODES_FILE).read_text())
    assert line["distance_to_goal_m"] is None
    assert read_records(tmp_path)[0].distance_to_goal_m == float("inf")


def test_an_episode_is_there_only_once(tmp_path):
    with store(tmp_path) as run:
        run.add(record())
        with pytest.raises(RunFolderError, match="house/0 is done already"):
            run.add(record())
    assert len(read_records(tmp_path)) == 1


def test_the_configuration_is_kept(tmp_path):
    filled(tmp_path)
    assert read_configuration(tmp_path) == CONFIGURATION


def test_another_configuration_is_refused_and_the_difference_shown(tmp_path):
    path = filled(tmp_path)
    before = path.read_bytes()
    other = {"agent": "frontier", "config": {"search": {"endurance_steps": 60}}}
    with pytest.raises(RunFolderError) as error, store(tmp_path, other):
        pass
    assert 'agent was "hypernav", is now "frontier"' in str(error.value)
    assert "config.search.endurance_steps was 40, is now 60" in str(error.value)
    assert path.read_bytes() == before


def test_differences_name_what_was_added_and_removed():
    assert differences({"a": 1, "b": {"c": 2}}, {"b": {"d": 3}}) == [
        "a was 1, is now absent",
        "b.c was 2, is now absent",
        "b.d was absent, is now 3",
    ]
    assert differences({"a": {"b": (1, 2)}}, {"a": {"b": [1, 2]}}) == []


def test_results_of_unknown_origin_are_refused(tmp_path):
    filled(tmp_path)
    (tmp_path / "run.json").unlink()
    with pytest.raises(RunFolderError, match="it is unknown how"), store(tmp_path):
        pass


@pytest.mark.parametrize("content", ["", "{", "[]", '{"configuration": 3}'])
def test_a_broken_configuration_is_named(tmp_path, content):
    filled(tmp_path)
    (tmp_path / "run.json").write_text(content)
    with pytest.raises(RunFolderError, match=r"run\.json"), store(tmp_path):
        pass


def test_a_folder_that_is_none_of_a_run_is_named(tmp_path):
    with pytest.raises(RunFolderError, match=r"no run\.json"):
        read_configuration(tmp_path)


@pytest.mark.slow
@given(cut=st.integers(min_value=1))
def test_a_last_line_cut_anywhere_costs_only_its_episode(tmp_path_factory, cut):
    folder = tmp_path_factory.mktemp("cut")
    path = filled(folder)
    whole = path.read_bytes()
    last = whole.splitlines(keepends=True)[-1]
    size = cut % (len(last) - 1)  # not the whole line
    path.write_bytes(whole[: len(whole) - len(last) + size])
    with store(folder) as run:
        assert list(run.records) == [("house", "0"), ("house", "1")]
        run.add(record("2"))
    assert path.read_bytes() == whole
    backups = sorted(folder.glob("*.cut-*"))
    assert [backup.read_bytes() for backup in backups] == ([last[:size]] if size else [])


def test_a_last_line_that_only_lacks_its_end_is_kept(tmp_path):
    path = filled(tmp_path)
    whole = path.read_bytes()
    path.write_bytes(whole[:-1])
    with store(tmp_path) as run:
        assert len(run.records) == 3
    assert path.read_bytes() == whole


def test_zeros_after_a_power_cut_are_cut_off_and_kept(tmp_path):
    path = filled(tmp_path)
    whole = path.read_bytes()
    path.write_bytes(whole + b"\0" * 100)
    with store(tmp_path) as run:
        assert len(run.records) == 3
    assert path.read_bytes() == whole
    assert (tmp_path / "episodes.jsonl.cut-1").read_bytes() == b"\0" * 100


def test_a_second_damage_does_not_overwrite_the_first_copy(tmp_path):
    path = filled(tmp_path)
    for text in (b"first", b"second"):
        path.write_bytes(path.read_bytes() + text)
        with store(tmp_path):
            pass
    assert (tmp_path / "episodes.jsonl.cut-1").read_bytes() == b"first"
    assert (tmp_path / "episodes.jsonl.cut-2").read_bytes() == b"second"


def test_damage_in_the_middle_is_named_and_nothing_is_changed(tmp_path):
    path = filled(tmp_path)
    lines = path.read_bytes().splitlines(keepends=True)
    damaged = b"".join([lines[0], b"garbage\n", lines[2]])
    path.write_bytes(damaged)
    with pytest.raises(RunFolderError, match="line 2 is damaged"), store(tmp_path):
        pass
    assert path.read_bytes() == damaged


def test_an_episode_that_is_there_twice_is_named(tmp_path):
    path = filled(tmp_path)
    path.write_bytes(path.read_bytes() * 2)
    with pytest.raises(RunFolderError, match="line 4: episode house/0 is there twice"):
        read_records(tmp_path)


def test_two_runs_in_one_folder_are_refused(tmp_path):
    with store(tmp_path) as first:
        first.add(record("0"))
        with pytest.raises(RunFolderError, match=f"in use.*process {os.getpid()}"), store(tmp_path):
            pass
        first.add(record("1"))
    assert len(read_records(tmp_path)) == 2


def _hold(folder, held):
    with store(folder):
        held.set()
        time.sleep(60)


def test_the_lock_of_a_killed_run_is_free_at_once(tmp_path):
    context = multiprocessing.get_context("spawn")
    held = context.Event()
    process = context.Process(target=_hold, args=(tmp_path, held))
    process.start()
    assert held.wait(30)
    with pytest.raises(RunFolderError, match="in use"), store(tmp_path):
        pass
    process.kill()
    process.join()
    with store(tmp_path):
        pass


def test_a_full_disk_loses_nothing_and_the_run_goes_on_afterwards(tmp_path):
    path = filled(tmp_path, 2)
    size = path.stat().st_size
    # Files of this process can't grow beyond half a line more: what a full disk looks like.
    program = (
        "import resource, sys; from pathlib import Path\n"
        "from eval_runs import record\n"
        "from hypernav.lab.evaluation.store.run_store import RunStore\n"
        f"run = RunStore(Path({str(tmp_path)!r}), {CONFIGURATION!r}).__enter__()\n"
        f"resource.setrlimit(resource.RLIMIT_FSIZE, ({size + 200}, resource.RLIM_INFINITY))\n"
        "run.add(record('2'))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        check=False,
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert "RunFolderError" in done.stderr
    assert "every episode up to now is safe" in done.stderr
    assert path.stat().st_size == size
    with store(tmp_path) as run:
        run.add(record("2"))
    assert [r.episode_id for r in read_records(tmp_path)] == ["0", "1", "2"]


def test_a_folder_that_cannot_be_made_is_an_error_with_its_reason(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(RunFolderError, match="cannot be written"), store(tmp_path / "file" / "run"):
        pass


def test_what_is_taken_out_runs_again_but_is_not_lost(tmp_path):
    with store(tmp_path) as run:
        run.add(record("0"))
        run.add(apart("1"))
        run.add(record("2"))
        assert run.withdraw(lambda r: not r.counts) == 1
        assert list(run.records) == [("house", "0"), ("house", "2")]
        run.add(record("1"))
    assert [r.episode_id for r in read_records(tmp_path)] == ["0", "2", "1"]
    assert len((tmp_path / "retried.jsonl").read_text().splitlines()) == 1


def test_every_start_has_a_line_from_its_first_moment(tmp_path, caplog):
    with store(tmp_path) as run:
        run.write_session(Session(began="today", workers=2))
    with (tmp_path / "sessions.jsonl").open("a") as file:
        file.write('{"workers": "many"}\n{broken')
    with store(tmp_path) as run:
        run.write_session(Session(began="tomorrow"))
        run.write_session(Session(began="tomorrow", ended="finished"))
    found = read_sessions(tmp_path)
    assert [(session.began, session.ended) for session in found] == [
        ("today", UNENDED),
        ("tomorrow", "finished"),
    ]
    assert found[0].workers == 2
    assert caplog.text.count("left out") == 2


@pytest.mark.parametrize("name", ["run.json", "episodes.jsonl", "sessions.jsonl"])
@pytest.mark.parametrize("kind", ["link", "link to nowhere", "pipe"])
def test_a_report_reads_only_files_of_the_runs_own(tmp_path, name, kind):
    folder = tmp_path / "run"
    with store(folder) as run:
        run.add(record())
        run.write_session(Session(began="now"))
    path = folder / name
    path.rename(tmp_path / "elsewhere")
    if kind == "pipe":
        os.mkfifo(path)
    else:
        path.symlink_to(tmp_path / ("elsewhere" if kind == "link" else "nowhere"))
    with pytest.raises(RunFolderError, match=f"{name} cannot be read: .* is a (link|pipe)"):
        _ = read_configuration(folder), read_records(folder), read_sessions(folder)


@pytest.mark.parametrize("saved", ["../elsewhere", "/etc", "episodes/..", "episodes/" + "x" * 5000])
def test_a_run_names_no_page_outside_its_folder(saved):
    line = record().model_dump() | {"saved": saved}
    with pytest.raises(ValidationError, match="saved"):
        EpisodeRecord.model_validate(line)


@pytest.mark.parametrize(
    "name",
    [".lock", ".lock.owner", ".run.json.new", ".sessions.jsonl.new", "episodes.jsonl"],
)
@pytest.mark.parametrize("kind", ["link", "hard link", "pipe"])
def test_a_run_from_a_stranger_leads_to_no_file_elsewhere(tmp_path, name, kind):
    mine, folder = tmp_path / "mine", tmp_path / "run"
    mine.write_text("")
    folder.mkdir()
    lead(folder / name, kind, mine)
    if name == "episodes.jsonl":
        (folder / "run.json").write_text(json.dumps({"configuration": CONFIGURATION}))
    told = ""
    try:
        with store(folder) as run:
            run.write_session(Session(began="now"))
            run.add(record())
    except RunFolderError as error:
        told = str(error)
    assert mine.read_text() == ""
    # A new file takes the place of an owner; to lock or to replace a hard link does no harm.
    is_harmless = name == ".lock.owner" or (kind == "hard link" and name != "episodes.jsonl")
    assert bool(told) != is_harmless, told
