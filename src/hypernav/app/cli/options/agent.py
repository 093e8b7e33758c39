"""The options that configure an agent or choose views, shared by several commands."""

from dataclasses import field
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import tyro

from hypernav.app.build.components.component_specs import ComponentSpecs, PresetName
from hypernav.app.cli.options.declaring import options
from hypernav.core.errors import ConfigError

if TYPE_CHECKING:
    from hypernav.app.build.built_agent import BuiltAgent
    from hypernav.app.build.components.exam_file import ExamFile
    from hypernav.app.build.presets import HyPerNavConfig
    from hypernav.app.cli.options.commands import FindOptions, ServeOptions
    from hypernav.core.embodiment import Embodiment


@options
class AgentOptions:
    """The agent and its components. It can be pickled, so that every process builds its own."""

    agent: str = "hypernav"
    """Agent: hypernav, frontier, vlfm, navvlm, vlmnav, pivot, dynavlm-style, pirlnav:FILE,
    zson:FILE or module:Name."""
    preset: PresetName = "default"
    """Values of the method: the published ones, those that measured better, or those of a
    published method's released code, with its mistakes."""
    native: bool = False
    """A published method's own camera, step and stop, not those common to all agents."""
    vlm: str | None = None
    """Vision-language model: openai:URL[#MODEL], local:PATH_OR_ID or replay:FILE."""
    detector: str | None = None
    """Detector of the goal, in place of --vlm: ground-truth, yolox:PATH.onnx, picodet:PATH.onnx, …;
    several are joined by +."""
    reasoner: str | None = None
    """What says where to go, in place of --vlm: geometric, …; for vlfm similarity:ID, …; auto:
    what --exam says."""
    segmenter: str | None = None
    """Segmenter of the pixels in a box: depth-cut, sam:ID, onnx-sam:ENC.onnx,DEC.onnx, …"""
    similarity: str | None = None
    """What compares key images of a memory with the goal's words: local:PATH_OR_ID or module:Name;
    none without it."""
    exam: Path | None = None
    """exam.json of hypernav exam about the model: answers count for what they are worth."""
    config: Path | None = None
    """YAML file with sections like those of result.json's config; only values that differ."""
    set: Annotated[tuple[str, ...], tyro.conf.arg(metavar="SECTION.KEY=VALUE")] = field(
        default_factory=tuple
    )
    """Single values that override the configuration, for example embodiment.camera.hfov_deg=60."""

    @property
    def specs(self) -> ComponentSpecs:
        """Specifications of agent, model and components.

        Raises:
            ConfigError: The reasoner is "auto", and no exam says which.
        """
        return self._examined()[0]

    @property
    def name(self) -> str:
        """Name of the agent for terminals and results; it says whether the mode is native."""
        return self._requested.name

    def step_limit(self, default: int) -> int:
        """The step limit of native mode; else the default.

        Raises:
            ConfigError: The agent has no native mode.
        """
        from hypernav.app.build.native import step_limit_of

        return step_limit_of(self.agent) if self.native else default

    def resolve(self, robot: "Embodiment | None" = None) -> "HyPerNavConfig":
        """The whole configuration: preset, robot, file, environment and single values, in order.

        Args:
            robot: Robot of a benchmark; None takes the preset's. Native mode has its own.

        Raises:
            ConfigError: A file that cannot be read, a wrong key or an impossible value.
        """
        from hypernav.app.build.components.choosing import choose_components, with_own_sections
        from hypernav.app.build.native import native_config
        from hypernav.app.build.presets import preset
        from hypernav.io.layered_config import layered

        self._check_preset()
        base = preset(self.preset)
        base = base if robot is None else base.model_copy(update={"embodiment": robot})
        base = native_config(self.agent, base) if self.native else base
        config = layered(base, file=self.config, assignments=self.set)
        specs, exam, unchecked = self._examined()
        if exam is not None:
            exam.check_is_of(specs)
            config = exam.applied(config, unchecked=unchecked)
        chosen = choose_components(specs, presence=config.presence.enabled)
        return with_own_sections(config, chosen)

    @property
    def _requested(self) -> ComponentSpecs:
        return ComponentSpecs(
            self.agent,
            self.vlm,
            self.detector,
            self.reasoner,
            self.segmenter,
            self.native,
            self.similarity,
        )

    def _examined(self) -> "tuple[ComponentSpecs, ExamFile | None, bool]":
        """The components, the exam, and whether it says not to check the presence of the goal."""
        requested = self._requested
        if self.exam is None and (requested.reasoner or "").lower() != "auto":
            return requested, None, False
        from hypernav.app.build.components.exam_file import read_exam, without_auto

        exam = None if self.exam is None else read_exam(self.exam)
        specs, unchecked = without_auto(requested, exam, self.preset)
        return specs, exam, unchecked

    def _check_preset(self) -> None:
        """Refuse the preset of another method, which would have no effect."""
        method, _, rest = self.preset.partition("-")
        if rest and method != self.agent:
            raise ConfigError(
                f"--preset {self.preset} is for --agent {method}, and this is {self.agent}; "
                "use --preset default"
            )

    def build(
        self, config: "HyPerNavConfig | None" = None, *, record: Path | None = None
    ) -> "BuiltAgent":
        """Build the agent.

        Args:
            config: Result of `resolve`; None calls it.
            record: File that records every exchange with the model; None for none.

        Raises:
            ConfigError: Options that do not exist or contradict each other.
            ModelError: A model's file cannot be used.
            RecordingError: A recording is missing or broken, or a file with its name exists.
            MissingExtraError: A part needs a package that is not installed.
        """
        from hypernav.app.build.agents import build_agent

        return build_agent(config or self.resolve(), self.specs, record=record)

    def describe(self, parts: "BuiltAgent") -> dict[str, Any]:
        """Description for ``result.json``: texts for people, specifications for repeating a run.

        Files given to components, such as weights, are identified by a hash of their content, and
        the questions to a model by a hash of their words.

        Raises:
            ModelError: Such a file can't be read.
        """
        from hypernav.app.build.components.fingerprints import digests

        prompts = {"prompts": parts.prompts} if parts.prompts else {}
        files = {"files": digests(parts.files)} if parts.files else {}
        return {
            "agent": self.name,
            "preset": self.preset,
            "detector": parts.detector_words,
            "reasoner": parts.reasoner_words,
            "segmenter": parts.segmenter.words,
            "model": parts.model_words,
            "parts": parts.chosen.as_dict(),
            **files,
            **prompts,
        }


def check_steps_and_seed(max_steps: int | None, seed: int) -> None:
    """Refuse numbers of steps and seeds that are out of bounds, in all commands that search.

    Raises:
        ConfigError: A number is out of bounds.
    """
    from hypernav.core.config import MOST_SEED, MOST_STEPS, check_option

    if max_steps is not None:
        check_option("--max-steps", max_steps, (1, MOST_STEPS), "steps of a search")
    check_option("--seed", seed, (0, MOST_SEED), "a whole number")


def check_memory_options(options: "FindOptions | ServeOptions") -> None:
    """Refuse an impossible size of a memory, and options about a memory where none is named.

    Raises:
        ConfigError: An option is impossible.
    """
    from hypernav.app.build.memories.building_memory import check_memory_size

    about_memory = {
        "--relocalize finds the start in": options.relocalize,
        "--similarity compares the images of": options.who.similarity,
        "--memory-mb is the size of": options.memory_mb is not None,
    }
    for words, is_given in about_memory.items():
        if is_given and options.memory is None:
            raise ConfigError(f"{words} a memory; add --memory FOLDER")
    check_memory_size("--memory-mb", options.memory_mb)


_Flat = tyro.conf.OmitArgPrefixes
"""Names without a prefix; the name of the field heads the group in help."""

FlatAgentOptions = Annotated[AgentOptions, tyro.conf.arg(name="agent"), _Flat]
"""Agent options as a field of a command's options: without a prefix on the command line."""


@options
class EmbodiedAgentOptions(AgentOptions):
    """The agent of a robot or a recording, which has its own camera and step."""

    native: tyro.conf.Suppress[tyro.conf.Fixed[bool]] = False


FlatEmbodiedAgentOptions = Annotated[EmbodiedAgentOptions, tyro.conf.arg(name="agent"), _Flat]


@options
class ViewOptions:
    """Where to show the search besides its own page and video."""

    view: Literal["page", "rerun", "foxglove"] | None = None
    """Watch the search live: page, in a browser, with a STOP; rerun, in its viewer; foxglove,
    at a WebSocket."""
    rrd: Path | None = None
    """File to record the search for rerun."""
    mcap: Path | None = None
    """File to record the search for Foxglove and other readers of MCAP."""
    pace: float | None = None
    """Largest number of steps a second, to watch them; 5 with --view page or foxglove, else no
    limit."""


@options
class RobotViewOptions:
    """Where to show what a robot does besides its page and video, and the server's page.

    The options of `ViewOptions` except those for the pace, which is the robot's own.
    """

    view: Literal["rerun", "foxglove"] | None = None
    """Watch it live: rerun, in its viewer; foxglove, at a WebSocket."""
    rrd: Path | None = None
    """File to record it for rerun."""
    mcap: Path | None = None
    """File to record it for Foxglove and other readers of MCAP."""

    @property
    def chosen(self) -> ViewOptions:
        """The same as options of all views."""
        return ViewOptions(view=self.view, rrd=self.rrd, mcap=self.mcap)


FlatRobotViewOptions = Annotated[RobotViewOptions, tyro.conf.arg(name="view"), _Flat]
FlatViewOptions = Annotated[ViewOptions, tyro.conf.arg(name="view"), _Flat]
