"""The study of goal refinement over the episodes of a data set, in one process."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from hypernav.app.build.agents import build_agent
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.components.construction import build
from hypernav.app.build.components.registries import DETECTORS, SEGMENTERS
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.app.build.worlds import open_world
from hypernav.core.components.protocols import Detector, Segmenter
from hypernav.core.episode import Episode
from hypernav.core.world import Simulator
from hypernav.lab.evaluation.refinement.area_record import AreaRecord, EpisodeAreas
from hypernav.lab.evaluation.refinement.episode_study import EpisodeStudy
from hypernav.lab.evaluation.store.record_file import RecordFile


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
