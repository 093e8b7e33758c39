"""Published results of other methods, with the differences of their protocols.

They are for orientation only: data sets, success distances, stop rules and step sizes differ, so
two rows can be compared only after reading all columns, and none is a target. Rows quoted from
another publication's table say so, and so do rows whose publication leaves something unstated.
"""

from dataclasses import dataclass

from hypernav.datasets import paper_results
from hypernav.datasets.paper_results import PaperRuns, RobotRow

_UNSTATED = "unstated"


@dataclass(frozen=True)
class Published:
    """One result of a publication.

    Attributes:
        method: Name of the method in the publication.
        dataset: Data set, its version and split.
        success_percent: Success rate, percent.
        spl_percent: SPL, percent.
        protocol: Protocol of the publication, and its differences from ours.
        source: Citation of the publication that holds the numbers.
        url: Address of that publication or of the method's code; empty if there is none to give.
        reached: What counts as reached, and the stop rule.
        step: Length of a step.
        step_seconds: Time of a step as the HyPerNav paper gives it, seconds; None where it
            doesn't.
    """

    method: str
    dataset: str
    success_percent: float
    spl_percent: float
    protocol: str
    source: str
    url: str = ""
    reached: str = _UNSTATED
    step: str = _UNSTATED
    step_seconds: float | None = None


_HABITAT = "STOP within 0.1 m of a view point"
_QUOTED = "as quoted by the HyPerNav paper, which did not run it again"
_VLMNAV_URL = "https://github.com/Jirl-upenn/VLMnav"
_VLMNAV_REACHED = "within 0.3 m of a view point, also when steps run out there"
_MACRO = "up to 1.7 m, and any turn"


def _quoted(method: str) -> tuple[float, float]:
    """SR and SPL of another method on HM3D, as the paper quotes them."""
    score = paper_results.OTHERS_ON_HM3D[method]
    return score.success_percent, score.spl_percent


def _in_simulation(runs: PaperRuns, version: str, step_seconds: float | None = None) -> Published:
    mean = runs.plain_mean
    return Published(
        "HyPerNav",
        f"{runs.title} {runs.split}{version}; {len(runs.scenes)} scenes are listed, with "
        f"{runs.episodes:,} episodes",
        runs.total.success_percent,
        runs.total.spl_percent,
        f"real scans; {paper_results.MODEL} is the main model, {paper_results.DETECTOR} gives the "
        f"boxes, {paper_results.SEGMENTER} the masks; run on "
        f"{paper_results.MACHINE}; camera and success distance are unstated. Plain means of the "
        f"scenes that it lists ({', '.join(runs.scenes)}) are {mean.success_percent:.1f} and "
        f"{mean.spl_percent:.1f}; the table is a clip, so its average is probably of more scenes",
        f"HyPerNav, tables “Average Performance in HM3D, OVON” and “{runs.table}”",
        step="0.5 m",
        step_seconds=step_seconds,
    )


def _with_robot(row: RobotRow) -> Published:
    return Published(
        "HyPerNav" if row.method == "HyPerNav" else "Nearest frontier",
        f"a real robot, {row.goal}, {row.found} of {row.searches} found",
        row.score.success_percent,
        row.score.spl_percent,
        paper_results.ROBOT_SETTING,
        f"HyPerNav, table “{paper_results.ROBOT_TABLE}”",
    )


PUBLISHED: tuple[Published, ...] = (
    _in_simulation(
        paper_results.HM3D,
        ", v1 to judge by its “around 100 episodes” a scene",
        paper_results.STEP_SECONDS["HyPerNav"],
    ),
    _in_simulation(paper_results.OVON, ""),
    *map(_with_robot, paper_results.ROBOT),
    Published(
        "VLFM",
        "HM3D-v1 val",
        *_quoted("VLFM"),
        "real scans, GroundingDINO, YOLOv7 and BLIP-2 see; habitat-lab's own objectnav_hm3d task "
        "with turns of 30°, half our step; a learned policy drives",
        "Yokoyama et al., VLFM, ICRA 2024",
        "https://arxiv.org/abs/2312.03275",
        _HABITAT,
        "0.25 m",
    ),
    Published(
        "VLFM",
        "MP3D val",
        36.4,
        17.5,
        "real scans; as on HM3D",
        "as reported by Aghaei et al., When Engineering Outruns Intelligence, 2025",
        "https://arxiv.org/abs/2507.20021",
        _HABITAT,
        "0.25 m",
    ),
    Published(
        "VLFM",
        "HM3D-OVON val unseen",
        35.2,
        19.6,
        "real scans; the original publication was not seen",
        "as reported by MetaNav",
    ),
    Published(
        "NavVLM",
        "HM3D val, version unstated",
        *_quoted("NavVLM"),
        "its released code is a demonstration of one scene without measures, and reproduces "
        "nothing of this: a camera of 90° at 1.1 m, 400 steps, sliding; the time of a step is "
        "as the HyPerNav paper gives it, which doesn't say who measured it, and where",
        _QUOTED,
        "https://github.com/Yonggie/NavVLM",
        step="0.3 m",
        step_seconds=paper_results.STEP_SECONDS["NavVLM"],
    ),
    Published(
        "VLMnav",
        "HM3D-v2 val, 1,000 episodes",
        *_quoted("VLMNav"),
        "real scans; camera of 131° at 1.5 m, 40 moves, sliding, Gemini 1.5 Flash; episodes that "
        "raise an error are not reported",
        _QUOTED,
        _VLMNAV_URL,
        _VLMNAV_REACHED,
        _MACRO,
    ),
    Published(
        "PIVOT",
        "HM3D-v2 val, 1,000 episodes",
        *_quoted("PIVOT"),
        "VLMnav's own run of it, by VLMnav's protocol; ten questions a move",
        _QUOTED,
        _VLMNAV_URL,
        _VLMNAV_REACHED,
        _MACRO,
    ),
    Published(
        "DyNaVLM",
        "HM3D val, version unstated",
        *_quoted("DyNaVLM"),
        "no code was published",
        _QUOTED,
        "https://arxiv.org/abs/2506.15096",
    ),
    Published(
        "PIRLNav, imitation only",
        "HM3D-v1 val",
        *_quoted("PIRLNav"),
        "real scans; trained on human demonstrations of exactly these six classes",
        "Ramrakhya et al., PIRLNav, in its repository",
        "https://github.com/Ram81/pirlnav",
        _HABITAT,
        "0.25 m",
    ),
    Published(
        "PIRLNav, finetuned",
        "HM3D-v1 val",
        70.4,
        34.1,
        "real scans; trained on human demonstrations of exactly these six classes, and finetuned "
        "by reward; the HyPerNav paper quotes the imitation alone",
        "Ramrakhya et al., PIRLNav, in its repository",
        "https://github.com/Ram81/pirlnav",
        _HABITAT,
        "0.25 m",
    ),
    Published(
        "ZSON",
        "HM3D-v1 val",
        *_quoted("ZSON"),
        "real scans; a policy trained to go to images, asked with words",
        _QUOTED,
        "https://github.com/gunagg/zson",
        _HABITAT,
        "0.25 m",
    ),
    Published(
        "ZSON",
        "MP3D val",
        15.3,
        4.8,
        "real scans; a policy trained to go to images, asked with words",
        "as reported by Aghaei et al., When Engineering Outruns Intelligence, 2025",
        "https://arxiv.org/abs/2507.20021",
        _HABITAT,
        "0.25 m",
    ),
    Published(
        "InstructNav",
        "HM3D-v1 val",
        58.0,
        20.9,
        "real scans, detection by GLEE and GPT-4 in the loop; 2,000 episodes of six categories",
        "as reported by Aghaei et al., When Engineering Outruns Intelligence, 2025",
        "https://arxiv.org/abs/2507.20021",
    ),
    Published(
        "DWFE (frontiers, no language model)",
        "HM3D-v1 val",
        61.1,
        36.0,
        "real scans; InstructNav without its GPT-4, detector and saliency map; 2,000 episodes",
        "Aghaei et al., When Engineering Outruns Intelligence, 2025",
        "https://arxiv.org/abs/2507.20021",
    ),
)
"""In the order in which they are shown; it is not a ranking."""
