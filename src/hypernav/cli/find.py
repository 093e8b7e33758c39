"""`hypernav find`: search for an object and leave a page about it."""

import re
from dataclasses import asdict, dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import tyro
from rich.console import Console
from rich.status import Status

from hypernav.build.agents import build_scene
from hypernav.cli.agent_options import AgentOptions, FlatAgentOptions
from hypernav.cli.warnings_shown import warnings_on
from hypernav.core.errors import ConfigError
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.evaluation.episode_run import EpisodeResult, EpisodeRun, EpisodeStep
from hypernav.evaluation.outcome import Outcome
from hypernav.evaluation.recorder import EpisodeRecorder
from hypernav.worlds.simulation import SimulatedWorld
from hypernav.worlds.surface.starts import random_start

MODEL_UNAVAILABLE_STATUS = 3
"""Exit status of a command whose model stayed away longer than the configured patience."""

_WORDS = {
    Outcome.FOUND: "[green]found[/] the {goal}",
    Outcome.WRONG_PLACE: "[red]stopped where no {goal} is[/]",
    Outcome.NOT_FOUND: "[yellow]did not find[/] the {goal}",
    Outcome.UNREACHABLE: "[yellow]no way leads[/] to the {goal} from this start",
    Outcome.MODEL_UNAVAILABLE: "[red]the model stayed away[/]; the search is not counted",
    Outcome.INTERRUPTED: "[yellow]interrupted[/] while looking for the {goal}",
}


@dataclass(frozen=True)
class Find:
    """Search for an object in a simulated building and leave a page about it."""

    goal: tyro.conf.Positional[str]
    """What to find: bed, "L-shaped sofa", …"""
    scene: str = "builtin"
    """The building: builtin, houses:N (any whole number N), or the path of a GLB."""
    options: FlatAgentOptions = field(default_factory=AgentOptions)
    """Who searches."""
    start: Annotated[tuple[float, float, float] | None, tyro.conf.arg(metavar="X Y YAW")] = None
    """Where to start in the scene: metres, and degrees counter-clockwise from x; else at random."""
    seed: int = 0
    """Of the random start and of all noise."""
    max_steps: int = 500
    """Step limit."""
    out: Path | None = None
    """Folder for the results; runs/<time>-<goal> by default."""
    quiet: bool = False
    """Say nothing but errors."""

    def run(self) -> int:
        """Run the command.

        Returns:
            0 if the goal was found, 1 if not, 3 if a model was not available.
        """
        if self.max_steps < 1:
            raise ConfigError(f"--max-steps {self.max_steps}: a search needs at least one step")
        if self.seed < 0:
            raise ConfigError(f"--seed {self.seed}: a seed is 0 or more")
        goal = Goal(self.goal)
        config = self.options.resolve()
        parts = self.options.build(config)
        parts.check_goal(goal)
        console = Console(stderr=True, quiet=self.quiet, highlight=False)
        with warnings_on(console), console.status("loading the building …") as status:
            world = SimulatedWorld(build_scene(self.scene), config.world)
            rng = np.random.default_rng(self.seed)
            start = self._start(world, goal, rng)
            episode = EpisodeRun(parts.agent, world, goal, start, rng=rng, max_steps=self.max_steps)
            folder = self.out or _new_folder(goal)
            with EpisodeRecorder(
                folder,
                goal=goal.text,
                agent=self.options.agent,
                detector=parts.detector_words,
                reasoner=parts.reasoner_words,
                step_limit=self.max_steps,
            ) as recorder:
                status.update("the first steps compile and take a few seconds …")
                interrupted = self._search(episode, recorder, status)
                status.update("writing the page …")
                outcome = episode.result(interrupted=interrupted)
                recorder.finish(
                    {
                        "goal": goal.text,
                        "scene": world.scene.name,
                        **self.options.describe(parts),
                        "seed": self.seed,
                        "start": [start.x, start.y, float(np.degrees(start.yaw))],
                        **_numbers(outcome),
                        **parts.take_report(),
                        "config": config.model_dump(mode="json"),
                    }
                )
        parts.close()
        self._say(console, outcome, folder)
        if interrupted:
            raise KeyboardInterrupt
        if outcome.outcome is Outcome.MODEL_UNAVAILABLE:
            return MODEL_UNAVAILABLE_STATUS
        return 0 if outcome.metrics.success else 1

    def _start(self, world: SimulatedWorld, goal: Goal, rng: np.random.Generator) -> Pose2:
        if self.start is None:
            return random_start(world.walkable, rng, world.regions.of(goal))
        x, y, yaw_deg = self.start
        return Pose2(x, y, float(np.radians(yaw_deg)))

    def _search(self, episode: EpisodeRun, recorder: EpisodeRecorder, status: Status) -> bool:
        """Run to the end; True if somebody pressed Ctrl-C."""
        try:
            for step in episode:
                recorder.add(step)
                status.update(_live_line(step, self.goal))
        except KeyboardInterrupt:
            return True
        return False

    def _say(self, console: Console, result: EpisodeResult, folder: Path) -> None:
        metrics = result.metrics
        console.print(_WORDS[result.outcome].format(goal=Goal(self.goal).thing))
        if result.detail:
            console.print(f"  {result.detail}", soft_wrap=True)
        console.print(
            f"  {result.steps} steps, {metrics.path_length_m:.1f} m driven, shortest "
            f"{metrics.shortest_path_m:.1f} m, SPL {metrics.spl:.2f}, "
            f"{metrics.distance_to_goal_m:.2f} m from the goal, {result.seconds['total']:.0f} s"
        )
        console.print(f"  open {folder / 'index.html'}", soft_wrap=True)


def _live_line(step: EpisodeStep, goal: str) -> str:
    trace = step.trace
    seen = f"{goal} in sight" if trace.goal_area else f"{goal} not seen yet"
    return f"step {trace.step + 1} · {trace.mode} · {seen} · {trace.reason}"


def _numbers(result: EpisodeResult) -> dict[str, Any]:
    return {
        "outcome": result.outcome.value,
        "detail": result.detail,
        "steps": result.steps,
        "model_calls": result.model_calls,
        **asdict(result.metrics),
        "seconds": {module: round(value, 3) for module, value in result.seconds.items()},
    }


def _new_folder(goal: Goal) -> Path:
    name = re.sub(r"[^a-z0-9]+", "-", goal.text.lower()).strip("-")[:40] or "goal"
    return Path("runs") / f"{datetime.now():%Y%m%d-%H%M%S}-{name}"
