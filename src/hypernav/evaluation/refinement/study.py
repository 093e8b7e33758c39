"""The study of goal refinement over the episodes of a data set, in one process."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from hypernav.build.agents import build_agent
from hypernav.build.component_specs import ComponentSpecs
from hypernav.build.construction import make, section_of
from hypernav.build.presets import HyPerNavConfig
from hypernav.build.registries import DETECTORS, SEGMENTERS, Factory
from hypernav.build.scenes import build_scene
from hypernav.core.components.registry import Choice
from hypernav.core.episode import Episode
from hypernav.evaluation.refinement.area_record import AreaRecord
from hypernav.evaluation.refinement.episode_study import EpisodeStudy
from hypernav.evaluation.refinement.store import RefinementStore
from hypernav.worlds.drawing.renderer import CpuRenderer, RenderConfig
from hypernav.worlds.simulation import SimulatedWorld


def run_refinement_study(
    episodes: Sequence[Episode],
    store: RefinementStore,
    config: HyPerNavConfig,
    specs: ComponentSpecs,
    *,
    seed: int = 0,
    watch: Callable[[int, int], None] | None = None,
) -> list[AreaRecord]:
    """Study all episodes that the store doesn't hold yet.

    Args:
        episodes: All episodes, the finished ones included.
        store: Folder of the study, open.
        config: Configuration of the method that is studied.
        specs: Its components. The detector, if one is named, gives the boxes of a third source, and
            the segmenter refines; the robot itself is driven by ground truth.
        seed: Seed of all noise.
        watch: Function that is called with the numbers of finished and of all episodes.

    Returns:
        The records of all episodes.

    Raises:
        HyPerNavError: A component can't be built, a scene can't be opened, or the disk is full.
    """
    study, scene_id, world, renderer = _study(config, specs, seed), None, None, None
    for episode in episodes:
        if watch is not None:
            watch(len(store.done), len(episodes))
        if episode.key in store.done:
            continue
        if world is None or renderer is None or scene_id != episode.scene_id:
            scene_id, scene = episode.scene_id, build_scene(episode.scene_id)
            renderer = CpuRenderer(scene, RenderConfig(threads=1))
            world = SimulatedWorld(scene, config.world, config.embodiment, renderer=renderer)
        store.add(episode, study.run(episode, world, renderer))
    return store.records


def _study(config: HyPerNavConfig, specs: ComponentSpecs, seed: int) -> EpisodeStudy:
    """The driving agent and the parts that are studied."""
    driver = build_agent(config, replace(specs, detector=None, segmenter=None)).agent
    segmenter = SEGMENTERS.find(specs.segmenter or "depth-cut")
    detector = None if specs.detector is None else DETECTORS.find(specs.detector)
    return EpisodeStudy(
        config,
        driver,
        _made(segmenter, "segmenter", config),
        None if detector is None else _made(detector, "detector", config),
        seed=seed,
    )


def _made(choice: Choice[Factory], kind: str, config: HyPerNavConfig) -> Any:
    section = section_of(choice, kind, config)
    return make(choice, {} if section is None else {"config": section})
