"""The configuration of a run, which is kept beside the results."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any

from hypernav.app.build.components.component_specs import BenchmarkName
from hypernav.app.build.data.datasets import (
    canonical_name,
    check_scenes,
    fingerprint,
    load_episodes,
    select,
)
from hypernav.app.build.data.sources import Progress
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.episode import MAX_STEPS, SUCCESS_DISTANCE_M, Episode
from hypernav.lab.datasets.benchmarks import benchmark_of
from hypernav.lab.datasets.goat import RUNNABLE, of_types
from hypernav.lab.evaluation.protocol import StopRule


@dataclass(frozen=True)
class Selection:
    """A selection of a data set's episodes. None selects all.

    Attributes:
        episodes: Positions in the data set's order, ``FIRST:END``.
        scenes: Scenes, separated by commas.
        goals: Goals, separated by commas.
    """

    episodes: str | None = None
    scenes: str | None = None
    goals: str | None = None


@dataclass(frozen=True)
class RunPlan:
    """Everything that decides about the results of a run; the number of workers does not.

    Attributes:
        dataset: Its name, as for `hypernav.app.build.data.datasets.load_episodes`.
        selection: Selection of its episodes.
        who: Description of the agent and its components in words, for people and reports.
        config: Values of the method, the robot and the camera.
        max_steps: Maximum number of steps of an episode.
        success_distance_m: Success distance of the run's own protocol; reports show others, too.
        seed: Seed of all noise.
        scenes_dir: Folder of the scenes that an episode file names; None takes the file's own.
        world: Simulator that the episodes run in.
        benchmark: Benchmark that was asked for by name; None follows the data set's own.
        max_life_steps: Maximum number of steps of a whole life; None for no limit of its own.
        fresh_memory: Whether the memory is emptied before each goal of a life.
        goal_types: Types of the goals to run, where the data set has several; by default all that
            can be run, which `chosen` fills in.
        left_out: Numbers of the goals of other types, filled in by `chosen`.
    """

    dataset: str
    selection: Selection = Selection()
    who: dict[str, Any] = field(default_factory=dict)
    config: HyPerNavConfig = field(default_factory=HyPerNavConfig)
    max_steps: int = MAX_STEPS
    success_distance_m: float = SUCCESS_DISTANCE_M
    seed: int = 0
    scenes_dir: Path | None = None
    world: str = "native"
    benchmark: BenchmarkName | None = None
    max_life_steps: int | None = None
    fresh_memory: bool = False
    goal_types: tuple[str, ...] = ()
    left_out: dict[str, int] = field(default_factory=dict)

    def episodes(self, progress: Progress | None = None) -> list[Episode]:
        """The episodes of `chosen`."""
        return self.chosen(progress)[1]

    def chosen(self, progress: Progress | None = None) -> tuple["RunPlan", list[Episode]]:
        """The chosen episodes of the data set, with the limits of this run.

        Args:
            progress: Function that is called with the progress of loading.

        Returns:
            This plan with the goal types that it runs and leaves out, and the episodes.

        Raises:
            EpisodeError: There is no such data set, the selection is empty, or a scene is missing.
            SceneError: A scene cannot be used.
        """
        own, followed = benchmark_of(self.dataset), benchmark_of(self.dataset, self.benchmark)
        as_in_files = followed is not None and followed.asks_as_in_files
        chosen = load_episodes(
            self.dataset,
            self.config.world,
            self.config.embodiment,
            scenes_dir=self.scenes_dir,
            as_in_files=as_in_files,
            progress=progress,
        )
        words = {} if own is None or as_in_files else own.words
        asked, left_out = self.selection, dict[str, int]()
        types = self.goal_types or (RUNNABLE if own is not None and own.goal_types else ())
        if types:  # what is left out is counted in the chosen episodes and scenes
            chosen = select(chosen, part=asked.episodes, scenes=asked.scenes)
            chosen, left_out = of_types(chosen, types)
            asked = Selection(goals=asked.goals)
        chosen = select(
            chosen, part=asked.episodes, scenes=asked.scenes, goals=asked.goals, words=words
        )
        check_scenes(chosen)
        limits = {
            "max_steps": self.max_steps,
            "success_distance_m": self.success_distance_m,
            "max_life_steps": self.max_life_steps,
        }
        plan = replace(self, goal_types=types, left_out=left_out)
        return plan, [replace(episode, **limits) for episode in chosen]

    def configuration(self, episodes: Sequence[Episode]) -> dict[str, Any]:
        """The content of ``run.json``.

        Args:
            episodes: Selected episodes. Their fingerprint is part of the configuration: the same
                name with other episodes (a newer generator of houses) is another run.
        """
        named: dict[str, Any] = {"world": self.world} if self.world != "native" else {}
        if self.benchmark is not None:
            named["benchmark"] = self.benchmark
        if self.goal_types:
            named["goal_types"] = {"run": list(self.goal_types), "left_out": self.left_out}
        return (
            {
                "hypernav": version("hypernav"),
                "dataset": canonical_name(self.dataset),
                "selection": asdict(self.selection),
                "episodes": {
                    "count": len(episodes),
                    "scenes": len({episode.scene_id for episode in episodes}),
                    "fingerprint": fingerprint(episodes),
                },
                "who": self.who,
                "protocol": {
                    "max_steps": self.max_steps,
                    "success_distance_m": self.success_distance_m,
                    "stop_rule": StopRule.STOP_REQUIRED.value,
                    "seed": self.seed,
                },
                "config": self.config.model_dump(mode="json"),
            }
            | named
            | ({"lives": lives} if (lives := self.lives(episodes)) else {})
            | self._navmeshes(episodes)
        )

    def lives(self, episodes: Sequence[Episode]) -> dict[str, Any]:
        """Number, memory and limit of the lives; empty if the episodes belong to none."""
        lives = {(episode.scene_id, episode.life) for episode in episodes if episode.life}
        if not lives:
            return {}
        if self.fresh_memory:
            memory = "emptied before each goal"
        elif self.who.get("keeps_memory", True):
            memory = "kept between goals"
        else:
            memory = "none, the agent keeps none"
        return {"count": len(lives), "memory": memory, "max_steps": self.max_life_steps}

    def _navmeshes(self, episodes: Sequence[Episode]) -> dict[str, Any]:
        """Number of scans with the file's own navmesh, and with one computed for the robot.

        Empty if no navmesh is computed.

        Raises:
            NavmeshError: A scan's mesh can't be used.
        """
        files = [
            path for scene in {e.scene_id for e in episodes} if (path := Path(scene)).is_file()
        ]
        if not files:
            return {}
        # imported here: a run of generated buildings reads no scans
        from hypernav.simulator.worlds.navmesh.robot_navmesh import is_computed
        from hypernav.simulator.worlds.scans.scan_loading import ScanFiles

        scans = [ScanFiles.of(file) for file in files]
        meshes = [scan.navmesh for scan in scans if scan is not None and scan.navmesh is not None]
        body, choice = self.config.embodiment.body, self.config.world.navmesh
        computed = sum(is_computed(mesh, body, choice) for mesh in meshes)
        both = {"file": len(meshes) - computed, "computed": computed}
        return {"navmeshes": both} if computed else {}
