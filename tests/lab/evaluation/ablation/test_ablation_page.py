"""Page, tables and figure of a study, from runs made by hand."""

import csv
import re

import numpy as np
import pytest

from certainty import certain
from eval_runs import apart, record
from hypernav.lab.evaluation.ablation.ablation_page import write_ablation
from hypernav.lab.evaluation.ablation.figures import results_figure
from hypernav.lab.evaluation.ablation.study import Axis, LeftOut, Study, Variant, read_results
from hypernav.lab.evaluation.failures import Failure
from hypernav.lab.evaluation.run_plan import RunPlan
from hypernav.lab.evaluation.store.run_store import RunStore

WHO = {
    "agent": "hypernav",
    "preset": "paper",
    "detector": "ground truth",
    "reasoner": "geometric",
    "parts": {"detector": "ground-truth"},
}
UNCHANGED = Variant("unchanged", "The method.")
WORSE = Variant("no <erosion>", "The mask is not eroded.", ("local.erosion_px=1",))
BETTER = Variant("bump sensor: on", "Feels walls.", ("planning.bump_sensor=true",))
LATER = Variant("later", "Not run yet.")
STUDY = Study(
    "Parts",
    (UNCHANGED, BETTER, WORSE, LATER),
    (LeftOut(Variant("no check", "Nobody asks."), "nobody is asked anyway"),),
)
SCENES = [f"house {number}" for number in range(8)]


def write(folder, variant, records, wanted=8):
    configuration = RunPlan("houses-val", who=WHO).configuration([])
    configuration["episodes"] |= {"count": wanted, "scenes": wanted}
    with RunStore(folder / variant.slug, configuration) as store:
        for one in records:
            store.add(one)


def found(length_m, scenes=SCENES):
    return [record("0", scene, shortest_path_m=4.0, path_length_m=length_m) for scene in scenes]


@pytest.fixture
def folder(tmp_path):
    """One variant loses in every house, one gains in all but one that is left to run."""
    write(tmp_path, UNCHANGED, found(8.0))
    lost = [record("0", scene, failure=Failure.NEVER_SEEN, stopped=False) for scene in SCENES]
    write(tmp_path, WORSE, lost)
    write(tmp_path, BETTER, found(4.0, SCENES[:-1]))
    return tmp_path


def test_the_page_says_what_is_lost_and_gained_and_what_is_missing(folder):
    page = certain(write_ablation(folder, STUDY)).read_text()
    text = re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", page))
    assert (
        "Unchanged, it finds 100.0 % (100.0 to 100.0 %) of its goals with an SPL of 0.500" in text
    )
    assert "SPL falls with “no &lt;erosion&gt;” (-0.500)." in text
    assert "SPL rises with “bump sensor: on” (+0.500)." in text
    assert "Not finished: bump sensor: on (7 of 8 episodes)" in text
    assert "Without results so far: later." in text
    assert "--set local.erosion_px=1" in text
    assert "Nobody is asked anyway no check" in text
    assert "simulator told the robot" in text
    assert "no <erosion>" not in page
    assert 'src="data:image/svg+xml;base64,' in page
    assert not re.search(r"(src|href)=\"(http|/|\w+\.)", page)


def test_too_few_scenes_to_show_anything_are_said_to_be_too_few(tmp_path):
    write(tmp_path, UNCHANGED, found(8.0, SCENES[:3]))
    write(tmp_path, WORSE, found(9.0, SCENES[:3]))
    page = certain(write_ablation(tmp_path, STUDY)).read_text()
    assert "With 3 scenes and 2 comparisons no corrected p-value can be below 0.5" in page
    (other,) = certain(read_results(tmp_path, STUDY)).variants
    assert certain(other.pair).spl.p_value == pytest.approx(0.25)


@pytest.mark.parametrize(("scenes", "has_interval"), [(4, False), (5, True)])
@pytest.mark.parametrize("goals", ["0", "01"])
def test_few_scenes_have_an_interval_nowhere(tmp_path, scenes, goals, has_interval):
    for variant, growth_m in ((UNCHANGED, 1.0), (WORSE, 2.0)):
        records = [
            record(goal, scene, shortest_path_m=4.0, path_length_m=5.0 + growth_m * k)
            for k, scene in enumerate(SCENES[:scenes])
            for goal in goals
        ]
        write(tmp_path, variant, records, wanted=len(records))
    page = certain(write_ablation(tmp_path, STUDY)).read_text()
    text = re.sub(r"\s+", " ", re.sub(r"<[^>]+>", " ", page))
    assert bool(re.search(r"\.\d+( to |–)[-+]?\d+\.\d", text)) is has_interval
    assert ("[" in (tmp_path / "ablation.tex").read_text()) is has_interval
    (row, *_) = csv.DictReader((tmp_path / "ablation.csv").read_text().splitlines())
    assert bool(row["spl_low"]) is bool(row["spl_high"]) is has_interval
    axes = results_figure(certain(read_results(tmp_path, STUDY))).axes
    widths = [np.ptp(np.asarray(line.get_xdata())) for one in axes for line in one.lines]
    assert any(widths) is has_interval


def test_the_worst_comes_first(folder):
    results = certain(read_results(folder, STUDY))
    assert [one.variant.name for one in results.worst_first] == [WORSE.name, BETTER.name]
    assert results.waiting == (LATER,)


def test_the_csv_holds_means_differences_and_failures(folder):
    write_ablation(folder, STUDY)
    with (folder / "ablation.csv").open() as file:
        rows = {row["variant"]: row for row in csv.DictReader(file)}
    assert list(rows) == [UNCHANGED.name, BETTER.name, WORSE.name]
    first, worse, better = rows[UNCHANGED.name], rows[WORSE.name], rows[BETTER.name]
    assert (first["success"], first["spl"], first["spl_difference"]) == ("1.0000", "0.5000", "")
    assert (worse["success_difference"], worse["never_seen"]) == ("-1.0000", "8")
    assert float(worse["success_difference_p"]) == pytest.approx(2 / 2**8, abs=1e-4)
    assert (better["spl_difference"], better["paired_episodes"]) == ("0.5000", "7")
    assert float(worse["success_difference_corrected_p"]) == pytest.approx(4 * 2 / 2**8, abs=1e-4)
    assert (worse["done"], better["done"]) == ("8 of 8 episodes", "7 of 8 episodes")
    assert worse["spl"] == "0.0000"
    assert better["spl"] == better["success_high"] == better["steps"] == ""  # of other episodes
    assert worse["changes"] == "--set local.erosion_px=1"


def test_the_latex_table_has_seven_columns_everywhere(folder):
    write_ablation(folder, STUDY)
    lines = (folder / "ablation.tex").read_text().splitlines()
    rows = [line for line in lines if line.endswith(r"\\")]
    assert len(rows) == 4
    assert all(row.count(" & ") == 6 for row in rows)
    assert any(row.startswith("bump sensor: on (7 of 8 episodes) & -- & -- & ") for row in rows)
    assert "corrected for the 4 comparisons of this table (Holm)" in lines[-1]


def test_the_same_results_give_the_same_bytes(folder):
    files = ("index.html", "ablation.csv", "ablation.tex", "figure.svg", "figure.png")
    write_ablation(folder, STUDY)
    before = [(folder / name).read_bytes() for name in files]
    write_ablation(folder, STUDY)
    assert [(folder / name).read_bytes() for name in files] == before


def test_a_figure_replaces_a_link(folder, tmp_path_factory):
    elsewhere = tmp_path_factory.mktemp("elsewhere") / "kept"
    elsewhere.write_text("kept")
    for name in ("figure.png", "figure.svg"):
        (folder / name).symlink_to(elsewhere)
    write_ablation(folder, STUDY)
    assert elsewhere.read_text() == "kept"


def test_a_study_of_quality_is_drawn_as_curves(folder):
    points = (
        Variant(WORSE.name, "", quality=0.0, curve="reasoner"),
        Variant(BETTER.name, "", quality=1.0, curve="reasoner"),
    )
    axes = (Axis("rate of truth", ("reasoner",), lines=(UNCHANGED.name,)),)
    write_ablation(folder, STUDY)
    bars = (folder / "figure.svg").read_bytes()
    page = write_ablation(folder, Study("Quality", (UNCHANGED, *points), axes=axes))
    assert (folder / "figure.svg").read_bytes() != bars
    assert "Over the quality" in certain(page).read_text()


def test_without_the_unchanged_method_there_is_nothing_to_compare_with(tmp_path):
    assert write_ablation(tmp_path, STUDY) is None
    write(tmp_path, UNCHANGED, [apart("0", SCENES[0])])
    assert write_ablation(tmp_path, STUDY) is None
    assert not (tmp_path / "index.html").exists()


def test_episodes_that_only_one_of_two_has_are_not_compared(tmp_path):
    write(tmp_path, UNCHANGED, found(8.0, SCENES[:2]))
    write(tmp_path, WORSE, found(8.0, SCENES[2:]))
    assert certain(read_results(tmp_path, STUDY)).waiting == (BETTER, WORSE, LATER)


def test_what_one_comparison_alone_would_show_is_not_shown_among_many(tmp_path):
    write(tmp_path, UNCHANGED, found(8.0))
    others = [Variant(f"other {number}", "") for number in range(5)]
    for variant in others:
        write(tmp_path, variant, found(9.0))
    page = certain(write_ablation(tmp_path, Study("Parts", (UNCHANGED, *others)))).read_text()
    assert "No difference in SPL is shown for any variant." in page  # 10 x 2 / 2**8
    assert "corrected for the 10 comparisons of this page" in page
    write_ablation(tmp_path, Study("Parts", (UNCHANGED, others[0])))
    assert "SPL falls with “other 0”" in (tmp_path / "index.html").read_text()


def test_with_a_single_scene_nothing_is_said_to_be_drawn_over_scenes(tmp_path):
    for variant, length in ((UNCHANGED, 8.0), (WORSE, 9.0)):
        records = [
            record(str(k), "house", shortest_path_m=4.0, path_length_m=length) for k in range(8)
        ]
        write(tmp_path, variant, records)
    page = certain(write_ablation(tmp_path, STUDY)).read_text()
    tex = (tmp_path / "ablation.tex").read_text()
    figure = (tmp_path / "figure.svg").read_text()
    for text in (page, tex, figure):
        assert "over episodes" in text
        assert "over scenes" not in text
