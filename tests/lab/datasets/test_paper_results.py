"""The numbers of the paper against its text, which lies beside the test data."""

import re
from pathlib import Path

import pytest

from hypernav.app.build.presets import preset
from hypernav.lab.datasets import paper_results as paper
from hypernav.lab.datasets.paper_results import HM3D, OVON, Score


@pytest.fixture(scope="module")
def text(test_data: Path) -> str:
    folder = test_data.parent / "paper"
    files = sorted(folder.glob("*.txt"))
    if not files:
        pytest.skip(f"the paper's text is not in {folder}")
    return "\n".join(file.read_text(encoding="utf-8") for file in files)


def rows(text: str, caption: str) -> list[list[str]]:
    """The rows of the LaTeX table with a caption, without markup, as lists of cells."""
    (table,) = [
        one
        for one in re.findall(r"\\begin\{table\}.*?\\end\{table\}", text, re.DOTALL)
        if caption in one
    ]
    plain = re.sub(r"\\cite\{[^}]*\}|\\hline|\\textbf|[{}]", "", table)
    return [[cell.strip() for cell in row.split("&")] for row in plain.split(r"\\")]


@pytest.mark.parametrize("runs", [HM3D, OVON])
def test_the_scenes_are_all_that_the_paper_prints(text, runs):
    printed: dict[str, Score] = {}
    for row in rows(text, runs.table):
        for scene, sr, spl in (row[:3], row[3:]) if len(row) == 6 else ():
            if scene.isdecimal():
                printed[scene] = Score(float(sr), float(spl))
    assert dict(runs.scenes) == printed


def test_averages_are_the_papers_own_and_those_that_it_quotes(text):
    printed = {row[0]: row[2:] for row in rows(text, "Average Performance") if len(row) == 6}
    hm3d = {
        name: Score(float(sr), float(spl))
        for name, (sr, spl, *_) in printed.items()
        if re.fullmatch(r"[\d.]+", sr)
    }
    assert hm3d == {**paper.OTHERS_ON_HM3D, "Ours": HM3D.total}
    assert Score(*map(float, printed["Ours"][2:])) == OVON.total


def test_the_robots_rows_are_the_papers(text):
    printed: dict[tuple[str, str], list[str]] = {}
    goal, methods = "", list[str]()
    for name, *cells in rows(text, "Real-world ablation"):
        if "frontier" in cells:
            goal, methods = name.split()[-1], cells
        for method, cell in zip(methods, cells, strict=False):
            printed.setdefault((goal, method), []).append(cell)
    for row in paper.ROBOT:
        found = f"{row.found}/{row.searches}", f"{row.score.success_percent:.0f}\\%"
        assert tuple(printed[row.goal, row.method][1:3]) == found
        assert 100 * float(printed[row.goal, row.method][3]) == pytest.approx(row.spl_percent)
    assert len(printed) == len(paper.ROBOT)


@pytest.mark.parametrize(
    "words",
    [
        f"We used {paper.MODEL} as main VLM",
        f"The detection is provided by {paper.DETECTOR} model",
        f"{paper.SEGMENTER}\\cite",
        "on GTX4080 server",
        f"includes {HM3D.episodes:,} navigation episodes",
        f"includes {OVON.episodes} navigation episodes",
        "around 100 episodes in HM3D",
        '``validation unseen" split of OVON, which consists of 3,000 episodes',
        f"is {paper.STEP_SECONDS['NavVLM']} seconds while HyPerNav's is "
        f"{paper.STEP_SECONDS['HyPerNav']} second",
        "drops 70\\% and 67\\% respectively",
        "Microsoft Azure DK",
        "RTX 4090 server",
        "half-human with a wheel base robot",
        "IMU-based odometry",
        "our lab office",
    ],
)
def test_the_setting_is_in_the_papers_words(text, words):
    assert words in text


def test_the_robots_rows_in_the_docs_are_the_data():
    page = (Path(__file__).parents[3] / "docs/results/paper.md").read_text(encoding="utf-8")
    for row in paper.ROBOT:
        cells = f"{row.found} of {row.searches} | {row.score.success_percent:.0f}"
        spl = f"{row.spl_percent / 100:.2f}"
        assert f"| {row.goal} | {row.method} | {cells} | {spl} |" in page


@pytest.mark.parametrize(("runs", "benchmark"), [(HM3D, "hm3d"), (OVON, "ovon")])
def test_the_docs_select_the_scenes_that_the_paper_prints(runs, benchmark):
    page = Path(__file__).parents[3].joinpath("docs", "hm3d.md").read_text(encoding="utf-8")
    command = page.partition(f"--benchmark hypernav-paper-{benchmark} ")[2].partition("--out")[0]
    assert f"--scenes {runs.selection} " in command


def test_the_preset_names_the_papers_networks():
    config = preset("paper")
    assert (config.chat.published_model, config.local.published_segmenter) == (
        paper.MODEL,
        paper.SEGMENTER,
    )
    assert list(paper.REFINEMENT_DROPS_PERCENT.values()) == [70, 67]
