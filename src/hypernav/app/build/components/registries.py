"""The registries of all components that are found by name, with those of this package.

Other packages register theirs as entry points of each registry's group.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from hypernav.core.components.protocols import (
    ArrowReasoner,
    BlockReasoner,
    Guide,
    SceneScorer,
)
from hypernav.core.components.registry import Entry, Registry

Factory = Callable[..., Any]
"""A class or function that makes a component from named arguments; see `construction.make`."""

DETECTORS: Registry[Factory] = Registry(
    "detector",
    "hypernav.detectors",
    [
        Entry(
            "ground-truth",
            "hypernav.search.perception.local.stand_ins.ground_truth:GroundTruthDetector",
            words="ground truth",
        ),
        Entry(
            "yolox",
            "hypernav.search.models.yolox:YoloxDetector",
            form="yolox:PATH.onnx",
            words="YOLOX ({files})",
            section="onnx_detector",
        ),
        Entry(
            "yolov8",
            "hypernav.search.models.yolov8:Yolov8Detector",
            form="yolov8:PATH.onnx",
            words="YOLOv8 ({files})",
            section="onnx_detector",
        ),
        Entry(
            "picodet",
            "hypernav.search.models.picodet:PicodetDetector",
            form="picodet:PATH.onnx",
            words="PicoDet ({files})",
            section="onnx_detector",
        ),
        Entry(
            "vlm",
            "hypernav.search.perception.local.vlm_detector:VlmDetector",
            words="{model}",
            section="grounding",
        ),
        Entry(
            "zero-shot",
            "hypernav.search.models.zero_shot:ZeroShotDetector",
            form="zero-shot:ID",
            section="zero_shot",
        ),
        Entry(
            "noisy",
            "hypernav.search.perception.local.stand_ins.noisy_detector:NoisyDetector",
            form="noisy:LEVEL",
            words="noisy ground truth ({files})",
            section="noisy_detector",
        ),
        Entry(
            "systematic",
            "hypernav.search.perception.local.stand_ins.systematic_detector:SystematicDetector",
            form="systematic:LEVEL",
            words="ground truth with systematic errors ({files})",
        ),
    ],
    together=Entry("together", "hypernav.search.models.detectors_together:DetectorsTogether"),
)
"""Detectors of the goal (`hypernav.core.components.protocols.Detector`)."""

SEGMENTERS: Registry[Factory] = Registry(
    "segmenter",
    "hypernav.segmenters",
    [
        Entry(
            "depth-cut",
            "hypernav.search.perception.local.depth_cut:DepthCutSegmenter",
            words="depth cut",
            section="depth_cut",
        ),
        Entry("sam", "hypernav.search.models.sam:SamSegmenter", form="sam:ID", section="sam"),
        Entry(
            "onnx-sam",
            "hypernav.search.models.sam:OnnxSamSegmenter",
            form="onnx-sam:ENCODER.onnx,DECODER.onnx",
            section="onnx_sam",
        ),
    ],
)
"""Segmenters of the pixels in a box (`hypernav.core.components.protocols.Segmenter`)."""

SIMILARITIES: Registry[Factory] = Registry(
    "similarity",
    "hypernav.similarities",
    [
        Entry(
            "local",
            "hypernav.search.models.similarity:load_similarity",
            form="local:PATH_OR_ID",
            words="similarity by {files}",
            section="similarity_scorer",
        ),
    ],
)
"""Models that compare key images of a memory with the goal's words
(`hypernav.core.components.protocols.ImageTextModel`)."""

REASONERS: Registry[Factory] = Registry(
    "reasoner",
    "hypernav.reasoners",
    [
        Entry(
            "geometric",
            "hypernav.search.perception.explorers.geometric_reasoner:GeometricReasoner",
            section="geometric",
        ),
        Entry(
            "vlm",
            "hypernav.search.perception.explorers.map_question:VlmReasoner",
            words="{model}",
            section="block_choice",
        ),
        Entry(
            "noisy",
            "hypernav.search.perception.explorers.noisy_reasoner:NoisyReasoner",
            form="noisy:P",
            words="noisy stand-in ({files} truly best)",
            section="block_choice",
        ),
        Entry(
            "random",
            "hypernav.search.perception.explorers.noisy_reasoner:RandomReasoner",
            words="random block",
            section="block_choice",
        ),
    ],
)
"""Reasoners that choose the block to visit (`hypernav.core.components.protocols.BlockReasoner`)."""

SCORERS: Registry[Factory] = Registry(
    "reasoner",
    "hypernav.scorers",
    [
        Entry(
            "truth",
            "hypernav.search.rivals.vlfm.scene_scorers:TruthScorer",
            words="the truth in view (stand-in)",
            section="truth_scorer",
        ),
        Entry(
            "similarity",
            "hypernav.search.rivals.vlfm.scene_scorers:SimilarityScorer",
            form="similarity:PATH_OR_ID",
            words="similarity by {files}",
            section="similarity_scorer",
        ),
        Entry(
            "vlm",
            "hypernav.search.rivals.vlfm.scene_scorers:ChatScorer",
            words="{model}",
            section="chat_scorer",
        ),
    ],
)
"""Scorers of views, for a value map (`hypernav.core.components.protocols.SceneScorer`)."""

ARROW_REASONERS: Registry[Factory] = Registry(
    "reasoner",
    "hypernav.arrow_reasoners",
    [
        Entry(
            "geometric",
            "hypernav.search.rivals.arrows.arrow_reasoners:GeometricArrowReasoner",
            words="free floor (stand-in)",
            section="arrows",
        ),
        Entry(
            "vlm",
            "hypernav.search.rivals.arrows.arrow_reasoners:ChatArrowReasoner",
            words="{model}",
            section="arrows",
        ),
    ],
)
"""Reasoners that choose among arrows in the camera image
(`hypernav.core.components.protocols.ArrowReasoner`)."""

GUIDES: Registry[Factory] = Registry(
    "reasoner",
    "hypernav.guides",
    [
        Entry(
            "truth",
            "hypernav.search.rivals.navvlm.guides:TruthGuide",
            words="the truth in view (stand-in)",
        ),
        Entry(
            "vlm",
            "hypernav.search.rivals.navvlm.guides:ChatGuide",
            words="{model}",
            section="chat_guide",
        ),
    ],
)
"""Guides that say directions in the image (`hypernav.core.components.protocols.Guide`)."""


@dataclass(frozen=True)
class Role:
    """A role of ``--reasoner`` in an agent, whose parameter's name says which role it uses.

    Attributes:
        registry: Registry of the components for the role.
        protocol: Protocol of these components.
        without_model: Name of the default component without a chat model; with one the default is
            ``vlm``.
    """

    registry: Registry[Factory]
    protocol: type
    without_model: str


ROLES = {
    "reasoner": Role(REASONERS, BlockReasoner, "geometric"),
    "scorer": Role(SCORERS, SceneScorer, "truth"),
    "arrow_reasoner": Role(ARROW_REASONERS, ArrowReasoner, "geometric"),
    "guide": Role(GUIDES, Guide, "truth"),
}
"""Roles by the names of the parameters of agents and explorers; each has one at most."""

AGENTS: Registry[Factory] = Registry(
    "agent",
    "hypernav.agents",
    [
        Entry(
            "hypernav",
            "hypernav.search.perception.explorers.block_explorer:BlockExplorer",
            section="overview",
        ),
        Entry(
            "frontier",
            "hypernav.search.rivals.nearest_frontier:NearestFrontierExplorer",
            words="nearest frontier",
        ),
        Entry(
            "vlfm",
            "hypernav.search.rivals.vlfm.value_frontier:ValueFrontierExplorer",
            words="VLFM's frontiers by value",
            section="value_frontier",
        ),
        Entry(
            "navvlm",
            "hypernav.search.rivals.navvlm.area_explorer:AreaExplorer",
            words="NavVLM's areas",
            section="navvlm",
        ),
        Entry(
            "vlmnav",
            "hypernav.search.rivals.arrows.arrow_explorer:VlmnavExplorer",
            words="VLMnav's arrows",
            section="arrows",
        ),
        Entry(
            "pivot",
            "hypernav.search.rivals.arrows.pivot:PivotExplorer",
            words="PIVOT's marks",
            section="arrows",
        ),
        Entry(
            "dynavlm-style",
            "hypernav.search.rivals.arrows.arrow_explorer:DynavlmStyleExplorer",
            words="points in DyNaVLM's style",
            section="arrows",
        ),
        Entry(
            "pirlnav",
            "hypernav.search.rivals.policy:PirlnavAgent",
            form="pirlnav:FILE",
            words="PIRLNav's policy ({files})",
            section="policy",
        ),
        Entry(
            "zson",
            "hypernav.search.rivals.policy:ZsonAgent",
            form="zson:FILE",
            words="ZSON's policy ({files})",
            section="policy",
        ),
    ],
)
"""Explorers, for which the search of this package drives, and whole agents
(`Explorer` and `Agent` of `hypernav.core.components.protocols`)."""

NATIVE_AGENTS: Registry[Factory] = Registry(
    "agent",
    "",
    [
        Entry(
            "vlmnav",
            "hypernav.search.rivals.arrows.prompted:NativeVlmnav",
            words="VLMnav's arrows",
            section="arrows",
        ),
        Entry(
            "pivot",
            "hypernav.search.rivals.arrows.prompted:NativePivot",
            words="PIVOT's marks",
            section="arrows",
        ),
    ],
)
"""Whole agents that take the place of explorers of the same name with ``--native``."""

COMPONENTS = (
    AGENTS,
    NATIVE_AGENTS,
    DETECTORS,
    SEGMENTERS,
    SIMILARITIES,
    *(role.registry for role in ROLES.values()),
)
"""The registries of all that an agent is made of."""
