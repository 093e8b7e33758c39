"""The study of goal refinement over the episodes of a data set, in one process.

Of each episode, the goal areas that every kind of box and mask gives for its frames. Ground-truth
detection drives the robot, so all box sources see the same frames.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool

from hypernav.app.build.agents import build_agent
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.components.construction import build
from hypernav.app.build.components.registries import DETECTORS, SEGMENTERS
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.app.build.worlds import open_world
from hypernav.core.components.abilities import ChecksGoal
from hypernav.core.components.protocols import Agent, Detector, Segmenter
from hypernav.core.episode import Episode
from hypernav.core.errors import GoalError
from hypernav.core.geometry.boxes import Box, Detection
from hypernav.core.observation import Observation
from hypernav.core.world import GoalTruth, SceneTruth, Simulator
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.lab.evaluation.refinement.area_record import (
    AreaRecord,
    BoxSource,
    EpisodeAreas,
    MaskSource,
)
from hypernav.lab.evaluation.refinement.boxes import is_wide_enough, jittered, matching
from hypernav.lab.evaluation.refinement.footprint import Footprint, OffTarget
from hypernav.lab.evaluation.refinement.goal_position import judge_position
from hypernav.lab.evaluation.store.record_file import RecordFile
from hypernav.search.memory.goal_area import GoalArea
from hypernav.search.perception.config import LocalConfig
from hypernav.search.perception.local.local_perception import eroded, projected
from hypernav.search.perception.local.stand_ins.ground_truth import GroundTruthDetector


@dataclass(frozen=True, eq=False)
class Frame:
    """A frame that shows the goal within the range of depth.

    Attributes:
        step: Number of the step.
        observation: Observation with colours.
        target: Detection of the largest goal in the image, with its true mask.
    """

    step: int
    observation: Observation
    target: Detection


class EpisodeStudy:
    """Runs episodes and counts their goal areas."""

    def __init__(
        self,
        config: HyPerNavConfig,
        agent: Agent,
        segmenter: Segmenter,
        detector: Detector | None = None,
        *,
        seed: int = 0,
    ) -> None:
        """Create it.

        Args:
            config: Configuration of the method that is studied.
            agent: Agent that drives, by ground truth.
            segmenter: Segmenter of the pixels in a box.
            detector: Real detector; None leaves its boxes out.
            seed: Seed of all noise.
        """
        self._config = config
        self._agent = agent
        self._segmenter = segmenter
        self._detector = detector
        self._seed = seed
        self._truth = GroundTruthDetector()

    def frames(self, episode: Episode, world: Simulator) -> Iterator[Frame]:
        """Drive an episode; yields the frames that show the goal within the range of depth.

        Args:
            episode: Episode of the world's scene.
            world: World that the robot is driven in.
        """
        world.colours = False  # drawn for the frames alone that are looked at
        rng = np.random.default_rng(episode.seed(self._seed))
        run = EpisodeRun(self._agent, world, episode, rng=rng)
        camera_to_scene = world.truth.camera_to_scene
        for step in run:
            found = self._truth.detect(step.observation, episode.goal)
            if found:
                truth = self._area(_mask_of(found[0]), step.observation, self._config.local)
                if truth is not None:
                    rgb = world.truth.view_from(camera_to_scene).rgb
                    observation = replace(step.observation, rgb=rgb)
                    yield Frame(step.trace.step, observation, found[0])
            camera_to_scene = world.truth.camera_to_scene

    def run(self, episode: Episode, world: Simulator) -> list[AreaRecord]:
        """Drive an episode; one record for every kind of box and mask that its frames gave."""
        records: dict[tuple[BoxSource, MaskSource], AreaRecord] = {}
        truth: _Truth | None = None
        for frame in self.frames(episode, world):
            truth = truth or _Truth.of(episode, world.truth, self._config.mapping.cell_size_m)
            for box_source, box in self._boxes(frame, episode).items():
                for mask_source, area in self.areas(frame, box).items():
                    kind = (box_source, mask_source)
                    record = records.get(kind) or AreaRecord.begun(episode, *kind)
                    if area is not None and record.position is None:
                        robot = frame.observation.robot
                        position = judge_position(
                            area, robot, world.truth, truth.goal, self._config
                        )
                        record = replace(record, position=position)
                    records[kind] = record.after(
                        None if area is None else OffTarget.of(area, truth.footprint)
                    )
        return list(records.values())

    def areas(self, frame: Frame, box: Box) -> dict[MaskSource, GoalArea | None]:
        """The goal areas made from a box; None if nothing is left to project."""
        observation, local = frame.observation, self._config.local
        height, width = observation.depth.shape
        pixels = np.zeros((height, width), dtype=bool)
        x_min, y_min, x_max, y_max = box.clipped(width, height).pixels()
        pixels[y_min:y_max, x_min:x_max] = True
        masks = {
            MaskSource.BOX: pixels,
            MaskSource.SEGMENTED: eroded(self._segmenter.segment(observation, box), local),
            MaskSource.TRUE: eroded(_mask_of(frame.target), local),
        }
        raw = local.model_copy(update={"dilation_iterations": 0, "entry_reach_m": 0.0})
        return {
            MaskSource.RAW: self._area(pixels, observation, raw),
            **{source: self._area(mask, observation, local) for source, mask in masks.items()},
        }

    def _area(
        self, mask: Bool[np.ndarray, "height width"], observation: Observation, local: LocalConfig
    ) -> GoalArea | None:
        area = projected(
            mask,
            observation,
            local,
            self._config.embodiment.camera,
            cell_size_m=self._config.mapping.cell_size_m,
        )
        if area is None or local.entry_reach_m == 0.0:
            return area
        return area.entered_from(observation, local.entry_reach_m)

    def _boxes(self, frame: Frame, episode: Episode) -> dict[BoxSource, Box]:
        true, observation = frame.target.box, frame.observation
        height, width = observation.depth.shape
        rng = np.random.default_rng([episode.seed(self._seed), frame.step])
        boxes = {
            BoxSource.TRUE: true,
            BoxSource.JITTERED: jittered(true, rng, width=width, height=height),
        }
        detector = self._detector_for(episode)
        if detector is not None:
            found = matching(true, detector.detect(observation, episode.goal))
            if found is not None:
                boxes[BoxSource.DETECTED] = found
        return {source: box for source, box in boxes.items() if is_wide_enough(box)}

    def _detector_for(self, episode: Episode) -> Detector | None:
        """The detector, unless it can never see the episode's goal."""
        if isinstance(self._detector, ChecksGoal):
            try:
                self._detector.check_goal(episode.goal)
            except GoalError:
                return None
        return self._detector


@dataclass(frozen=True, eq=False)
class _Truth:
    """The ground truth about an episode's goal.

    Attributes:
        goal: Instances that satisfy it, and their view points.
        footprint: Their footprint in the episode's ``map`` frame.
    """

    goal: GoalTruth
    footprint: Footprint

    @staticmethod
    def of(episode: Episode, scene: SceneTruth, cell_size_m: float) -> "_Truth":
        goal = scene.goal_truth(episode.goal, episode.view_points)
        ids = [instance.id for instance in goal.instances]
        footprint = Footprint.of_instances(scene, ids, scene.map_to_scene, cell_size_m)
        return _Truth(goal, footprint)


def _mask_of(target: Detection) -> Bool[np.ndarray, "height width"]:
    assert target.mask is not None, "ground truth detections carry their masks"
    return target.mask


def run_refinement_study(
    episodes: Sequence[Episode],
    file: RecordFile[EpisodeAreas],
    config: HyPerNavConfig,
    specs: ComponentSpecs,
    *,
    seed: int = 0,
    watch: Callable[[int, int], None] | None = None,
) -> list[AreaRecord]:
    """Study all episodes that the file doesn't hold yet.

    Args:
        episodes: All episodes, the finished ones included.
        file: What the study has found so far.
        config: Configuration of the method that is studied.
        specs: Its components. The detector, if one is named, gives the boxes of a third source, and
            the segmenter refines; the robot itself is driven by ground truth.
        seed: Seed of all noise.
        watch: Function that is called with the numbers of finished and of all episodes.

    Returns:
        The records of all episodes, ordered by scene and episode.

    Raises:
        HyPerNavError: A component can't be built, a scene can't be opened, or the disk is full.
    """
    study, opened = _study(config, specs, seed), _OpenScene(config)
    for episode in episodes:
        if watch is not None:
            watch(len(file.records), len(episodes))
        if episode.key not in file.records:
            areas = study.run(episode, opened.of(episode.scene_id))
            scene_id, episode_id = episode.key
            file.add(EpisodeAreas(scene_id=scene_id, episode_id=episode_id, areas=tuple(areas)))
    return [area for _, one in sorted(file.records.items()) for area in one.areas]


class _OpenScene:
    """The world of one scene, which stays open until another is needed."""

    def __init__(self, config: HyPerNavConfig) -> None:
        self._config = config
        self._opened: tuple[str, Simulator] | None = None

    def of(self, scene_id: str) -> Simulator:
        if self._opened is None or self._opened[0] != scene_id:
            if self._opened is not None:
                self._opened[1].close()
            self._opened = (scene_id, open_world(scene_id, self._config, threads=1))
        return self._opened[1]


def _study(config: HyPerNavConfig, specs: ComponentSpecs, seed: int) -> EpisodeStudy:
    """Build the driving agent and the components that are studied."""
    driver = build_agent(config, replace(specs, detector=None, segmenter=None)).agent
    segmenter = SEGMENTERS.find(specs.segmenter or "depth-cut")
    detector = None if specs.detector is None else DETECTORS.find(specs.detector)
    return EpisodeStudy(
        config,
        driver,
        build(segmenter, "segmenter", Segmenter, config, {}),
        None if detector is None else build(detector, "detector", Detector, config, {}),
        seed=seed,
    )
