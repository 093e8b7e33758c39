"""The whole configuration, and the presets."""

import difflib
import math
from typing import Any, get_args

from pydantic import Field, model_validator

from hypernav.app.build.components.component_specs import PresetName
from hypernav.core.config import RoomConfig
from hypernav.core.embodiment import Embodiment
from hypernav.core.errors import ConfigError
from hypernav.core.naming.words import megabytes
from hypernav.io.layered_config import with_values
from hypernav.io.reading import MOST_BYTES
from hypernav.search.agents.config import SearchConfig
from hypernav.search.mapping.config import MappingConfig, memory_of
from hypernav.search.models.chat.config import ChatConfig
from hypernav.search.models.config import (
    OnnxDetectorConfig,
    OnnxSamConfig,
    SamConfig,
    SimilarityScorerConfig,
    ZeroShotConfig,
)
from hypernav.search.perception.config import (
    DepthCutConfig,
    DetectorQuality,
    GeometricConfig,
    ImageRecallConfig,
    LocalConfig,
    OverviewConfig,
    PresenceConfig,
    VlmDetectorConfig,
    VlmReasonerConfig,
)
from hypernav.search.planning.config import PlanningConfig
from hypernav.search.rivals.config import (
    AreaConfig,
    ArrowsConfig,
    ChatGuideConfig,
    ChatScorerConfig,
    PolicyConfig,
    PromptedConfig,
    TruthScorerConfig,
    ValueFrontierConfig,
)
from hypernav.simulator.worlds.config import SimulationConfig


class PriceConfig(RoomConfig):
    """Prices of a model's tokens; None leaves the cost out of the results.

    Attributes:
        in_per_million: Price, in any currency, of a million prompt tokens.
        out_per_million: Price, in the same currency, of a million answer tokens.
    """

    in_per_million: float | None = Field(default=None, ge=0.0, le=1e9)
    out_per_million: float | None = Field(default=None, ge=0.0, le=1e9)


class OwnConfig(RoomConfig):
    """Sections of components from other packages; each is checked by the component's own model.

    Attributes:
        agent: Section of the agent or explorer in use.
        detector: Section of the detector in use.
        reasoner: Section of the reasoner in use.
        segmenter: Section of the segmenter in use.
    """

    agent: dict[str, Any] = Field(default_factory=dict)
    detector: dict[str, Any] = Field(default_factory=dict)
    reasoner: dict[str, Any] = Field(default_factory=dict)
    segmenter: dict[str, Any] = Field(default_factory=dict)


class HyPerNavConfig(RoomConfig):
    """The whole configuration, one section for each part.

    Attributes:
        embodiment: Body, camera, step and turn of the robot.
        world: Simulation of the robot.
        mapping: Cells, evidence and height band of the map.
        local: Local perception, from detections to goal areas.
        overview: Drawing and repetition of the map question.
        geometric: Weights of blocks without a model.
        planning: Planning and path following.
        search: Conditions for looking, stopping and changing the destination.
        chat: Connection to chat models, timeouts and retries.
        grounding: Question to a chat model for boxes.
        block_choice: Map question to a chat model.
        presence: Question to a chat model whether the goal is really there.
        image_recall: Remembered images: question to a chat model, least similarity to the goal.
        price: Prices of tokens, for the cost in the results.
        depth_cut: Segmentation of a box without a model.
        onnx_detector: Use of a YOLOX or PicoDet export.
        zero_shot: Use of an open-vocabulary detector.
        sam: Use of a SAM model.
        onnx_sam: Use of an exported SAM.
        noisy_detector: Error rates of the detector noisy:custom, which stands in for a model.
        value_frontier: VLFM's choice of a frontier.
        truth_scorer: Errors of the stand-in that scores views by the truth.
        similarity_scorer: Scores of views, and use, of a model that compares images with texts.
        chat_scorer: Scores of views by a chat model.
        navvlm: NavVLM's areas and turns.
        chat_guide: Question about directions to a chat model.
        arrows: Moves drawn into the image, of VLMnav, PIVOT and in DyNaVLM's style.
        prompted: Budget and stop of agents that make long moves (native mode).
        policy: Choice of an action by a trained policy.
        own: Sections of components from other packages.
    """

    embodiment: Embodiment = Embodiment()
    world: SimulationConfig = SimulationConfig()
    mapping: MappingConfig = MappingConfig()
    local: LocalConfig = LocalConfig()
    overview: OverviewConfig = OverviewConfig()
    geometric: GeometricConfig = GeometricConfig()
    planning: PlanningConfig = PlanningConfig()
    search: SearchConfig = SearchConfig()
    chat: ChatConfig = ChatConfig()
    grounding: VlmDetectorConfig = VlmDetectorConfig()
    block_choice: VlmReasonerConfig = VlmReasonerConfig()
    presence: PresenceConfig = PresenceConfig()
    image_recall: ImageRecallConfig = ImageRecallConfig()
    price: PriceConfig = PriceConfig()
    depth_cut: DepthCutConfig = DepthCutConfig()
    onnx_detector: OnnxDetectorConfig = OnnxDetectorConfig()
    zero_shot: ZeroShotConfig = ZeroShotConfig()
    sam: SamConfig = SamConfig()
    onnx_sam: OnnxSamConfig = OnnxSamConfig()
    noisy_detector: DetectorQuality = DetectorQuality()
    value_frontier: ValueFrontierConfig = ValueFrontierConfig()
    truth_scorer: TruthScorerConfig = TruthScorerConfig()
    similarity_scorer: SimilarityScorerConfig = SimilarityScorerConfig()
    chat_scorer: ChatScorerConfig = ChatScorerConfig()
    navvlm: AreaConfig = AreaConfig()
    chat_guide: ChatGuideConfig = ChatGuideConfig()
    arrows: ArrowsConfig = ArrowsConfig()
    prompted: PromptedConfig = PromptedConfig()
    policy: PolicyConfig = PolicyConfig()
    own: OwnConfig = OwnConfig()

    def with_(self, **sections: Any) -> "HyPerNavConfig":
        """The configuration with other values, such as ``search={"endurance_steps": 60}``.

        Args:
            **sections: By the name of the section, either the values that differ, or a whole
                section such as an `Embodiment`.

        Raises:
            ConfigError: A wrong key or an impossible value.
        """
        return with_values(self, sections, source="with_")

    def for_steps(self, max_steps: int) -> "HyPerNavConfig":
        """The configuration of searches that end after so many steps.

        Its agent knows that, unless its `search.max_steps` says something else than the default.
        """
        if self.search.max_steps != SearchConfig().max_steps:
            return self
        search = self.search.model_copy(update={"max_steps": max_steps})
        return self.model_copy(update={"search": search})

    @model_validator(mode="after")
    def _map_holds_the_body(self) -> "HyPerNavConfig":
        self.mapping.height_band(self.embodiment.body)
        return self

    @model_validator(mode="after")
    def _map_holds_the_view(self) -> "HyPerNavConfig":
        reach_m = self.embodiment.camera.max_depth_m
        cells = math.ceil(2.0 * reach_m / self.mapping.cell_size_m) ** 2
        size = memory_of(cells, self.mapping.height_band(self.embodiment.body))
        if size > MOST_BYTES:
            raise ConfigError(
                f"a map of all that a camera with a range of {reach_m:g} m sees around it would "
                f"take {megabytes(size)}, at most {megabytes(MOST_BYTES)} are allowed; use a "
                "larger mapping.cell_size_m or a smaller embodiment.camera.max_depth_m"
            )
        return self

    @property
    def stop_reach_m(self) -> float:
        """Largest distance from the outline of a goal area at which the robot stops, metres."""
        local = self.local
        dilated_m = (
            local.dilation_kernel // 2 * local.dilation_iterations * self.mapping.cell_size_m
        )
        near_m = max(self.search.stop_distance_m, self.search.approach_gap_m)
        return near_m + max(local.entry_reach_m - dilated_m, 0.0)


ARROWS_AS_RELEASED: dict[str, Any] = {"slide_marks": False, "blind_step_m": 0.2}
"""What VLMnav's and PIVOT's released code does with arrows; in native mode it is so as well."""
_AS_RELEASED: dict[str, dict[str, Any]] = {
    "vlfm-as-released": {
        "value_frontier": {"visited_radius_m": 0.0},
        "search": {"look_again_before_giving_up": False, "claim_when_explored": True},
    },
    "navvlm-as-released": {"navvlm": {"visited_radius_m": 0.0, "clear_rows": True}},
    "vlmnav-as-released": {
        "arrows": {**ARROWS_AS_RELEASED, "count_short": True, "space_explored": False},
    },
    "pivot-as-released": {
        "arrows": {**ARROWS_AS_RELEASED, "count_short": True, "zero_is_last": True},
    },
}
"""Where the released code of published methods differs from its own intention or from ours."""


def preset(name: PresetName | str) -> HyPerNavConfig:
    """A named configuration: the published method, or the one measured to be better.

    ``…-as-released`` is ``default`` with the mistakes of a published method's released code.

    docs/method.md says which sentence of the paper each value comes from, and which are ours.

    Raises:
        ConfigError: There is no such preset.
    """
    names: tuple[str, ...] = get_args(PresetName)
    if name not in names:
        close = difflib.get_close_matches(str(name), names, n=1)
        hint = f"did you mean '{close[0]}'? " if close else ""
        raise ConfigError(f"there is no preset {name!r:.40}; {hint}presets: {', '.join(names)}")
    if name == "default":
        return HyPerNavConfig()
    if name != "paper":
        return HyPerNavConfig().with_(**_AS_RELEASED[name])
    return HyPerNavConfig(
        mapping=MappingConfig(
            pass_weight=0, free_footprint=False, sees_drops=False, block_destination="middle"
        ),
        local=LocalConfig(
            published_segmenter="MobileSAM",
            keep_thin_masks=False,
            min_points=1,
            largest_cluster_only=False,
            entry_reach_m=0.0,
            target="latest",
            look_closer_below=0.0,
        ),
        overview=OverviewConfig(
            image_px=768,
            strong_colors=False,
            draw_frontier=False,
            fill_obstacles=False,
            clear_numbers=False,
            label_things=False,
            visited="positions",
            max_questions=None,
            forget_visits=True,
            last_frontier_m=None,
        ),
        geometric=GeometricConfig(gain="boundary", order="greedy", min_frontier_cells=0),
        planning=PlanningConfig(
            margin_m=0.12,
            squeeze_m=0.0,
            prefer_known=False,
            comfort_cost=0.0,
            unknown_cost=1.0,
            targets="nearest-straight",
            start_in_obstacle="nearest",
            end_in_obstacle="nearest",
            max_gap_m=None,
            waypoints="dense",
            replan_every_steps=10,
            replan_when_moved=False,
            steering="waypoint",
            bump_sensor=False,
        ),
        search=SearchConfig(
            stop_distance_m=0.45,
            approach_gap_m=0.45,
            local_first=True,
            give_up_when_stuck=False,
            end_when_explored=False,
            look_around_at_start=False,
            look_again_before_giving_up=False,
            look_across_boundary=False,
            least_unseen_m2=None,
            drop_explored=False,
            reconsider_steps=None,
            verify_view="current",
            face_target=False,
            see_before_stop=False,
            enter_in_sight=False,
            enter_fully=False,
            go_nearer=False,
            open_the_way=False,
            use_stairs=False,
            pursue_far_sightings=False,
            recall=False,
        ),
        chat=ChatConfig(published_model="QwenVL-7B"),
        grounding=VlmDetectorConfig(score_crops=0, min_score=0.0),
        presence=PresenceConfig(unsure="yes"),
        image_recall=ImageRecallConfig(max_questions=0),
        onnx_detector=OnnxDetectorConfig(score_threshold=0.3),
        block_choice=VlmReasonerConfig(
            mode="paper",
            facts=False,
            list_excluded=True,
            min_frontier_cells=0,
            max_blocks=None,
            skip_only_block=False,
        ),
    )
