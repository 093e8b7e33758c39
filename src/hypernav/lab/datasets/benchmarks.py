"""The published benchmarks of this field: robot, limits, success distance and names of goals."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from hypernav.core.embodiment import BodyConfig, CameraConfig, Embodiment, MotionConfig
from hypernav.core.episode import MAX_STEPS, SUCCESS_DISTANCE_M
from hypernav.core.errors import ConfigError
from hypernav.lab.datasets import paper_results
from hypernav.lab.datasets.paper_results import PaperRuns

_HABITAT_STEP_M = 0.2
"""Habitat's navigation meshes: a robot climbs edges of up to 0.2 m, so also stairs."""


@dataclass(frozen=True)
class Benchmark:
    """What a benchmark specifies, and where its files are.

    Attributes:
        name: Name of the data source, as in ``hm3d:DIR``.
        title: Name for people.
        embodiment: The published robot.
        source: Publication of these values.
        episodes: Folders of its episodes below the data folder, with ``*`` for the version.
        splits: Published splits that are evaluated; the first is the default.
        scenes: Folders of its scenes below the folder of all scenes, the preferred one first.
        episodes_from: Where to get its episodes, for people.
        scenes_from: Where to get its scenes, for people.
        max_steps: Step limit.
        max_life_steps: Step limit of a life, where episodes are those of lives; None for none.
        success_distance_m: Geodesic distance to a view point within which a STOP counts, metres.
        words: Names of the goals by category of the files, where the two differ.
        asks_as_in_files: Whether goals are named as in the files, even if the data set has names of
            its own.
        segmenter: Segmenter that the publication states; a run has to name the one that it uses.
        model: Vision-language model that it states; likewise.
        printed: What the HyPerNav paper prints of its runs on this data set, if it ran on it.
        goal_types: Types of its goals, where it has several.
        caveats: Sentences about what the publication leaves open. They are shown before a run and
            in its reports.
    """

    name: str
    title: str
    embodiment: Embodiment
    source: str
    episodes: tuple[str, ...] = ()
    splits: tuple[str, ...] = ("val",)
    scenes: tuple[str, ...] = ()
    episodes_from: str = ""
    scenes_from: str = ""
    max_steps: int = MAX_STEPS
    max_life_steps: int | None = None
    success_distance_m: float = SUCCESS_DISTANCE_M
    words: Mapping[str, str] = field(default_factory=dict)
    asks_as_in_files: bool = False
    segmenter: str = ""
    model: str = ""
    printed: PaperRuns | None = None
    goal_types: tuple[str, ...] = ()
    caveats: tuple[str, ...] = ()


_LOCOBOT = Embodiment(
    # The camera and the depth range are those of the default robot, Habitat's own.
    body=BodyConfig(radius_m=0.18, height_m=1.0, max_step_m=_HABITAT_STEP_M),
    camera=CameraConfig(),
    motion=MotionConfig(forward_m=0.25, turn_angle_deg=30.0),
)
"""Habitat's ObjectNav robot. Its navigation mesh rounds the height of 0.88 m up to 1.0 m."""

_STRETCH = Embodiment(
    body=BodyConfig(radius_m=0.17, height_m=1.41, max_step_m=_HABITAT_STEP_M),
    camera=CameraConfig(width=360, height=640, hfov_deg=42.0, height_m=1.31),
    motion=MotionConfig(forward_m=0.25, turn_angle_deg=30.0),
)
"""The Stretch robot of OVON, with its camera upright."""

_HM3D_SCENES = "with a licence from https://matterport.com/habitat-matterport-3d-research-dataset"

_HM3D = Benchmark(
    name="hm3d",
    title="HM3D ObjectNav",
    printed=paper_results.HM3D,
    embodiment=_LOCOBOT,
    source="habitat-lab, benchmark/nav/objectnav/objectnav_hm3d.yaml",
    episodes=(
        "datasets/objectnav/hm3d/*",
        "objectnav/hm3d/*",
        "datasets/objectnav/objectnav_hm3d_*",
        "datasets/objectnav_hm3d_*",
        "objectnav_hm3d_*",
    ),
    scenes=("hm3d_v0.2", "hm3d"),
    episodes_from="objectnav_hm3d_v1.zip and objectnav_hm3d_v2.zip of habitat-lab's DATASETS.md",
    scenes_from=_HM3D_SCENES,
    # VLFM (Yokoyama et al., 2024) and the methods that follow it, vlfm/policy/habitat_policies.py.
    words={"plant": "potted plant", "tv_monitor": "tv", "sofa": "couch"},
)

_MP3D = Benchmark(
    name="mp3d",
    title="MP3D ObjectNav",
    embodiment=_LOCOBOT,
    source="habitat-lab, benchmark/nav/objectnav/objectnav_mp3d.yaml; turns of the challenge",
    episodes=(
        "datasets/objectnav/mp3d/*",
        "objectnav/mp3d/*",
        "datasets/objectnav/objectnav_mp3d_*",
        "datasets/objectnav_mp3d_*",
        "objectnav_mp3d_*",
    ),
    scenes=("mp3d",),
    episodes_from="objectnav_mp3d_v1.zip of habitat-lab's DATASETS.md",
    scenes_from=(
        "with a licence from https://niessner.github.io/Matterport (download_mp.py --task habitat)"
    ),
    # VLFM's words, except where they name other things (a nightstand for a chest of drawers) or
    # several at once (table, dining table, …).
    words={
        "plant": "potted plant",
        "tv_monitor": "tv",
        "sofa": "couch",
        "cushion": "pillow",
        "picture": "framed photograph",
    },
)

_OVON = Benchmark(
    name="ovon",
    title="HM3D-OVON",
    printed=paper_results.OVON,
    embodiment=_STRETCH,
    source="Yokoyama et al., HM3D-OVON, 2024, section IV, and its objectnav_stretch_hm3d.yaml",
    episodes=(
        "datasets/ovon/hm3d/*",
        "datasets/ovon/hm3d",
        "ovon/hm3d/*",
        "ovon/hm3d",
        "hm3d_ovon/hm3d/*",
        "hm3d_ovon/hm3d",
        "datasets/ovon/*",
        "ovon/*",
    ),
    splits=("val_seen", "val_seen_synonyms", "val_unseen"),
    scenes=("hm3d_v0.2", "hm3d"),
    episodes_from="hm3d.tar.gz of https://huggingface.co/datasets/nyokoyama/hm3d_ovon",
    scenes_from=_HM3D_SCENES,
    success_distance_m=0.25,
)

_GOAT = Benchmark(
    name="goat",
    title="GOAT-Bench",
    embodiment=_STRETCH,
    source="Khanna et al., GOAT-Bench, 2024, and its goat_stretch_hm3d.yaml",
    episodes=(
        "datasets/goat_bench/hm3d/*",
        "goat_bench/hm3d/*",
        "datasets/goat_bench/*",
        "goat_bench/*",
    ),
    splits=("val_unseen", "val_seen", "val_seen_synonyms"),
    scenes=("hm3d_v0.2", "hm3d"),
    episodes_from="linked in the README of https://github.com/Ram81/goat-bench",
    scenes_from=_HM3D_SCENES,
    max_steps=5000,
    max_life_steps=5000,
    success_distance_m=0.25,
    goal_types=("object", "description", "image"),
    caveats=(
        "GOAT-Bench has two rules that contradict each other: its README counts a STOP within 1 m "
        "of the object, after at most 500 steps a goal; its code one within 0.25 m (geodesic) of a "
        "view point, with 5,000 steps for all goals of an episode. Runs follow the code; reports "
        "have both.",
        "The robot doesn't look up and down, which the benchmark allows.",
    ),
)

_UNSTATED_BY_PAPER = (
    "The HyPerNav paper states steps of 0.5 m, turns of 30° and 500 steps; its success distance "
    "and its camera are not stated, so this run uses those of the data set, which is our choice."
)


def _as_in_the_paper(
    benchmark: Benchmark, printed: PaperRuns, split: str, version: str
) -> Benchmark:
    """A data set with the protocol of the HyPerNav paper, as far as it states it.

    Args:
        benchmark: The data set with its own protocol.
        printed: What the paper prints of its runs on it.
        split: Split that the paper evaluates.
        version: Sentence about the version of the episodes.
    """
    motion = MotionConfig(forward_m=0.5, turn_angle_deg=30.0)
    scenes = (
        f"The paper prints SR and SPL of {len(printed.scenes)} scenes with {printed.episodes:,} "
        f"episodes: --scenes {printed.selection} selects them, and hypernav report --published "
        "sets them beside this run's."
    )
    return replace(
        benchmark,
        name=f"hypernav-paper-{benchmark.name}",
        title=f"{benchmark.title} by the protocol of the HyPerNav paper",
        embodiment=benchmark.embodiment.model_copy(update={"motion": motion}),
        source=(
            "HyPerNav, simulation evaluation: forward 0.5 m, turn 30°, 500 steps, "
            f"{paper_results.MODEL}, {paper_results.SEGMENTER}"
        ),
        splits=(split,),
        words={},
        asks_as_in_files=True,
        segmenter=paper_results.SEGMENTER,
        model=paper_results.MODEL,
        caveats=(scenes, version, _UNSTATED_BY_PAPER),
    )


BENCHMARKS = {
    one.name: one
    for one in (
        _HM3D,
        _MP3D,
        _OVON,
        _GOAT,
        _as_in_the_paper(
            _HM3D,
            paper_results.HM3D,
            "val",
            "The paper names no version. It says that a scene has around 100 episodes, which fits "
            "v1 (2,000 in 20 scenes) and not v2 (1,000 in 36).",
        ),
        _as_in_the_paper(
            _OVON,
            paper_results.OVON,
            "val_unseen",
            "Its split is OVON's val unseen, 3,000 episodes in 36 scenes.",
        ),
    )
}
"""All benchmarks, by name."""

GENERATED = Benchmark(
    name="generated",
    title="generated buildings",
    embodiment=Embodiment(),
    source="this package",
    episodes=("datasets/objectnav/hypernav",),
    splits=(),
    scenes=("hypernav",),
    episodes_from="hypernav houses export houses-val --out DIR",
    scenes_from="with hypernav houses export houses-val --out DIR",
)
"""What `hypernav houses export` writes; all splits that exist."""


STOREYS = Benchmark(
    name="storeys",
    title="generated buildings with stairs",
    embodiment=Embodiment(body=BodyConfig(max_step_m=_HABITAT_STEP_M)),
    source="this package",
)
"""What runs in these buildings follow: a robot that climbs their stairs."""


def robot_in(scene: str) -> Embodiment | None:
    """The robot that a scene is made for: one that climbs in buildings with stairs; else None.

    Args:
        scene: Name of the scene, such as ``storeys:3``.
    """
    return STOREYS.embodiment if scene.startswith(f"{STOREYS.name}:") else None


def benchmark_of(dataset: str, name: str | None = None) -> Benchmark | None:
    """The benchmark that a run follows.

    Args:
        dataset: Data set of the run, such as ``hm3d:DIR#val``.
        name: Benchmark that was asked for by name; None takes the data set's own.

    Returns:
        None if none was named and the data set has none: buildings of one storey, scenes, files.

    Raises:
        ConfigError: There is no benchmark of this name.
    """
    if name is None:
        if dataset.startswith((f"{STOREYS.name}-", f"scene:{STOREYS.name}:")):
            return STOREYS
        return BENCHMARKS.get(dataset.partition(":")[0])
    if name not in BENCHMARKS:
        raise ConfigError(f"there is no benchmark '{name:.40}'; use {', '.join(BENCHMARKS)}")
    return BENCHMARKS[name]
