"""The table of a field study: lengths by odometry, shortest paths by hand."""

from pathlib import Path

import numpy as np
import pytest

from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.app.cli.main import main
from hypernav.core.errors import RunFolderError
from hypernav.lab.evaluation.field_study import ALL_GOALS, TrialResult, study_rows
from hypernav.robot.field_trial import read_trial
from hypernav.robot.server.searches.journal import EndRecord, Journal, SearchRecord
from hypernav.robot.wire.frames import pack_observation
from hypernav.robot.wire.replies import SearchEnding
from hypernav.robot.wire.requests import ObservationFacts, OpenSearch
from hypernav.robot.wire.values import PlanarPose


def finished(
    folder: Path,
    by_hand: str | None = "shortest_m: 2.0",
    *,
    ending: SearchEnding | None = SearchEnding.FOUND,
    agent: str = "hypernav",
) -> Path:
    """A search that drove 4 m: 2 m out and 2 m back, while its localisation jumped."""
    record = SearchRecord(
        id="0" * 32,
        opened_s=0.0,
        version="0",
        words="",
        request=OpenSearch(goal="bed"),
        specs=ComponentSpecs(agent=agent),
        config=HyPerNavConfig(),
    )
    journal = Journal.create(folder, record)
    for number, x in enumerate((0.0, 1.0, 2.0, 1.0, 0.0)):
        facts = ObservationFacts(
            sequence=number,
            stamp_s=0.0,
            base_to_odom=PlanarPose(x=x),
            odom_to_map=PlanarPose(x=0.1 * number),
        )
        image = np.zeros((8, 8, 3), np.uint8)
        journal.add_observation(pack_observation(facts, image, np.ones((8, 8), np.float32)))
    if ending is not None:
        journal.write_end(EndRecord(ending=ending), {}, last_floor=1)
    journal.close()
    if by_hand is not None:
        (folder / "trial.yaml").write_text(by_hand)
    return folder


def test_spl_is_the_shortest_length_by_hand_over_that_of_the_odometry(tmp_path):
    trial = read_trial(finished(tmp_path))
    assert trial.metrics.success
    assert trial.metrics.path_length_m == pytest.approx(4.0)
    assert trial.metrics.spl == pytest.approx(0.5)


@pytest.mark.parametrize(
    ("by_hand", "ending", "success"),
    [
        ("shortest_m: 2.0\nsuccess: true", SearchEnding.FOUND, True),
        ("shortest_m: 2.0\nsuccess: false", SearchEnding.FOUND, False),
        ("shortest_m: 2.0\nsuccess: true", SearchEnding.GAVE_UP, False),
        ("shortest_m: 2.0", SearchEnding.GAVE_UP, False),
    ],
)
def test_a_success_needs_the_robots_stop_and_nobody_who_denies_it(
    by_hand, ending, success, tmp_path
):
    trial = read_trial(finished(tmp_path, by_hand, ending=ending))
    assert trial.metrics.success is success
    assert (trial.metrics.spl > 0.0) is success


@pytest.mark.parametrize(
    ("by_hand", "message"),
    [
        (None, "shortest_m"),
        ("shortest_m: -1", "shortest_m"),
        ("shortest: 2.0", "shortest"),
        ("shortest_m: [", "trial.yaml"),
    ],
)
def test_measures_that_are_missing_or_wrong_are_named(by_hand, message, tmp_path):
    with pytest.raises(RunFolderError, match=message):
        read_trial(finished(tmp_path, by_hand))


def test_a_search_under_way_is_no_trial(tmp_path):
    with pytest.raises(RunFolderError, match="not finished"):
        read_trial(finished(tmp_path, ending=None))


def test_rows_are_methods_within_goals_and_then_all_goals():
    results = [
        TrialResult("bed", "hypernav", True, 0.8, 5.0, 4.0),
        TrialResult("bed", "frontier", False, 0.0, 9.0, 4.0),
        TrialResult("chair", "hypernav", True, 0.6, 5.0, 3.0),
        TrialResult("chair", "frontier", True, 0.2, 15.0, 3.0),
    ]
    rows = study_rows(results)
    assert [(row.goal, row.method, row.count, row.found) for row in rows] == [
        ("bed", "hypernav", 1, 1),
        ("bed", "frontier", 1, 0),
        ("chair", "hypernav", 1, 1),
        ("chair", "frontier", 1, 1),
        (ALL_GOALS, "hypernav", 2, 2),
        (ALL_GOALS, "frontier", 2, 1),
    ]
    assert rows[-2].spl.mean == pytest.approx(0.7)
    assert rows[-1].success.mean == pytest.approx(0.5)


def test_the_command_prints_the_table_and_leaves_outages_out(tmp_path, capsys):
    folders = [
        finished(tmp_path / "a"),
        finished(tmp_path / "b", agent="frontier", ending=SearchEnding.GAVE_UP),
        finished(tmp_path / "c", ending=SearchEnding.MODEL_UNAVAILABLE),
    ]
    table = tmp_path / "table.csv"
    with pytest.raises(SystemExit) as left:
        main(["robot", "report", *map(str, folders), "--csv", str(table)])
    assert left.value.code == 0
    said = capsys.readouterr().out
    assert "1 of 1" in said
    assert "hypernav" in said  # whole, in 80 columns
    assert "outage" in said
    assert "0.500 to" not in said  # one trial has no interval
    assert table.read_text().splitlines()[1].startswith("bed,hypernav,1,1,1.0000,0.5000")
