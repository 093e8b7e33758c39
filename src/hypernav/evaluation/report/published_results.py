"""Published results of other methods, with the differences of their protocols.

Only numbers that stand in the cited publication's own text are listed. They are there for
orientation: data sets, success distances, stop rules and step sizes differ, so no number here can
be set against another row without reading the last column.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Published:
    """One result of a publication.

    Attributes:
        method: Name of the method in the publication.
        dataset: Data set and split.
        success_percent: Success rate, percent.
        spl_percent: SPL, percent.
        protocol: Protocol of the publication, and its differences from ours.
        source: Citation of the publication.
        url: Address of the publication.
    """

    method: str
    dataset: str
    success_percent: float
    spl_percent: float
    protocol: str
    source: str
    url: str


PUBLISHED: tuple[Published, ...] = (
    Published(
        "VLFM",
        "HM3D val",
        52.5,
        30.4,
        "real scans, GroundingDINO, YOLOv7 and BLIP-2 see; habitat-lab's own objectnav_hm3d task "
        "with turns of 30° and its step of 0.25 m, half of ours",
        "Yokoyama et al., VLFM, ICRA 2024",
        "https://arxiv.org/abs/2312.03275",
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
"""In the order in which they are shown."""
