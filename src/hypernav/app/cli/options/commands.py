"""The options of the commands, but for those of `hypernav robot`.

For a fast start, this module imports very little.
"""

from dataclasses import field
from pathlib import Path
from typing import Annotated, Any, Literal

import tyro

from hypernav.app.build.components.component_specs import BenchmarkName, PresetName
from hypernav.app.cli.options.agent import (
    AgentOptions,
    EmbodiedAgentOptions,
    FlatAgentOptions,
    FlatEmbodiedAgentOptions,
    FlatViewOptions,
    ViewOptions,
)
from hypernav.app.cli.options.declaring import options
from hypernav.app.cli.robot import RobotOptions
from hypernav.lab.evaluation.choices import SaveChoice, StudyName


@options
class FindOptions:
    """The goal, the building, the agent, and the folder of the results."""

    goal: tyro.conf.Positional[str]
    """The object to find: bed, "L-shaped sofa", …"""
    scene: str = "builtin"
    """The building: builtin, houses:N, offices:N, shops:N, crowded:N or storeys:N (any whole number
    N), or the path of a GLB, another model or a Gazebo world."""
    world: str = "native"
    """Simulator: native, habitat if it is installed, or module:Name of one of your own."""
    who: FlatAgentOptions = field(default_factory=AgentOptions)
    """The options that configure the agent."""
    start: Annotated[tuple[float, ...] | None, tyro.conf.arg(metavar="X Y YAW [Z]")] = None
    """Start pose in the scene: metres, and degrees counter-clockwise from x; then the height of its
    floor in metres, where it isn't the main one. Random by default."""
    seed: int = 0
    """Seed of the random start and of all noise."""
    max_steps: int | None = None
    """Maximum number of steps; 500 by default, or those of --native."""
    memory: Path | None = None
    """Folder with what earlier searches learned of the building; this one adds to it."""
    memory_mb: float | None = None
    """Size of that folder, MB, beyond which the images that tell least are forgotten, from now on;
    at first 50."""
    relocalize: bool = False
    """Start without knowing where in the memory, and find out by turning once around; where that
    fails, search without the memory."""
    out: Path | None = None
    """Folder of the results; runs/<time>-<goal> by default."""
    record: Path | None = None
    """File that records every exchange with the model of --vlm, for --vlm replay:FILE."""
    views: FlatViewOptions = field(default_factory=ViewOptions)
    """The options that choose views."""
    quiet: bool = False
    """Print errors only."""


@options
class EvalOptions:
    """The episodes, the agent, the number of workers, and the folder of the results."""

    dataset: tyro.conf.Positional[str]
    """houses-val, houses-ovon, houses-train[#FIRST:END], offices-…, shops-…, crowded-train,
    storeys-…, houses-life-…, offices-life-…, storeys-life-…, scene:GLB[#STARTS], habitat:FILE,
    hm3d:DIR[#SPLIT], mp3d:DIR[#SPLIT], ovon:DIR[#SPLIT], goat:DIR[#SPLIT] or module:Name."""
    who: FlatAgentOptions = field(default_factory=AgentOptions)
    """The options that configure the agent."""
    out: Path | None = None
    """Folder of the run; runs/<dataset>-<agent> by default."""
    benchmark: BenchmarkName | None = None
    """Published robot, step limit and success distance; hm3d:, mp3d:, ovon: and goat: have their
    own.
    hypernav-paper-hm3d and -ovon also name goals as the files do."""
    episodes: str | None = None
    """Only these episodes, by position in the data set: FIRST:END (END is not included). Where
    there are lives, only these lives."""
    scenes: str | None = None
    """Only these scenes, separated by commas: names, house or HM3D numbers, or positions from 0."""
    goals: str | None = None
    """Only these goals, separated by commas."""
    goal_types: str | None = None
    """Only these types of GOAT-Bench's goals: object, description or both, with a comma between
    them; by default both. Image goals can't be run yet."""
    scenes_dir: Path | None = None
    """Folder of the scenes that the episodes name; by default the data set's own folder."""
    world: str = "native"
    """Simulator: native, habitat if it is installed, or module:Name of one of your own."""
    workers: int | None = None
    """Number of processes, one core each; by default the number of cores, but one with
    --vlm local:…, which every process loads."""
    ray: str | None = None
    """Address of a Ray cluster, or auto, to run the workers there instead."""
    save: SaveChoice = "none"
    """Episodes that keep their page and video: all, the failed ones, or none."""
    max_steps: int | None = None
    """Maximum number of steps of an episode; by default that of --native or of the benchmark,
    else 500."""
    success_distance: float | None = None
    """Distance to a view point that counts as reached, metres, by default the benchmark's, else
    0.1; reports show 0.1, 0.2, 0.25, 0.3 and 1.0, too."""
    seed: int = 0
    """Seed of all noise."""
    fresh_memory: bool = False
    """Empty the memory before each goal of a life, to measure what the memory is worth."""
    plan: bool = False
    """Only say what the run would cost: by --exam, without any search; else by the first ten
    episodes, which the same command without --plan doesn't run again."""
    quiet: bool = False
    """Print errors only."""


@options
class _VariedAgent(AgentOptions):
    """The agent; its preset is described as the one that is varied."""

    preset: Annotated[PresetName, tyro.conf.arg(name="of")] = "default"
    """Preset that is varied: with default, also every value that differs from the paper's."""


@options
class AblateOptions(EvalOptions):
    """The episodes, the method and its variants; other options are as in hypernav eval."""

    who: Annotated[_VariedAgent, tyro.conf.arg(name="agent"), tyro.conf.OmitArgPrefixes] = field(
        default_factory=_VariedAgent
    )
    """The options that configure the agent, in all variants."""
    out: Path | None = None
    """Folder of the page, with a folder for every variant; runs/<…>-ablation by default."""
    study: StudyName = "switches"
    """What is studied: the switches of the method, the quality of the model, or the step from a box
    to the goal area (refinement)."""
    only: str | None = None
    """Only these variants, separated by commas, and the unchanged method; --list names them."""
    list: bool = False
    """List the variants and what each of them sets, and run nothing."""


@options
class ReportOptions:
    """The evaluations to report on, and the folder of the report."""

    runs: tyro.conf.Positional[tuple[Path, ...]]
    """Folders that hypernav eval wrote; the first is the one that others are compared with."""
    compare: bool = False
    """Compare every run with the first one, episode by episode."""
    published: bool = False
    """Set every run beside the HyPerNav paper's rows, scene by scene and goal by goal."""
    out: Path | None = None
    """Folder of the report; by default that of the only run, or compared/ in the first run's."""
    quiet: bool = False
    """Print errors only."""


@options
class RunsOptions:
    """The folder, and whether its page is made anew."""

    folder: Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="[DIR]")] = Path("runs")
    """Folder in which runs of find, eval and ablate lie, at any depth; the page is runs.html in
    it."""
    follow: bool = False
    """Make the page anew whenever a run has changed, as while eval runs, until Ctrl-C."""
    quiet: bool = False
    """Print errors only."""


@options
class DoctorOptions:
    """The model or the data to examine, and how a model is asked."""

    vlm: str | None = None
    """Model to examine: openai:URL[#MODEL] or local:PATH_OR_ID."""
    data: Path | None = None
    """Data folder to examine, as in hm3d:DIR: which parts of the benchmarks are there?"""
    config: Path | None = None
    """YAML file with sections like those of result.json's config; only values that differ."""
    set: Annotated[tuple[str, ...], tyro.conf.arg(metavar="SECTION.KEY=VALUE")] = field(
        default_factory=tuple
    )
    """Single values that override the configuration, for example grounding.family=qwen3-vl."""


@options
class ExamOptions:
    """Who is examined, with which questions, and where the results go."""

    vlm: str | None = None
    """Model to examine: openai:URL[#MODEL], local:PATH_OR_ID or replay:FILE."""
    detector: str | None = None
    """Detector to examine in the model's place, or alone: yolox:PATH.onnx, picodet:PATH.onnx, …"""
    calibrate: bool = False
    """Instead of the questions, measure in training buildings what the scores of this network are
    worth, and keep it beside its file, where searches find it."""
    segmenter: str | None = None
    """Segmenter to examine: depth-cut, sam:ID, onnx-sam:ENC.onnx,DEC.onnx, …"""
    reasoner: str | None = None
    """What chooses blocks, in the model's place, or alone: geometric, noisy:P, …"""
    size: Literal["quick", "full"] = "quick"
    """quick: 203 questions to a model; full: 1,015."""
    bank: Literal["val", "train"] = "val"
    """val, which nothing is tuned on; train for work on prompts."""
    preset: PresetName = "default"
    """Values of the method, which hold the words of its questions."""
    config: Path | None = None
    """YAML file with sections like those of result.json's config; only values that differ."""
    predict: int = 40
    """Number of episodes in which stand-ins that err like the model search, to predict what it
    reaches: minutes, without the model. 0 predicts nothing."""
    compare: tuple[Path, Path] | None = None
    """Two such files: the model answers the same questions with both, and they are compared."""
    set: Annotated[tuple[str, ...], tyro.conf.arg(metavar="SECTION.KEY=VALUE")] = field(
        default_factory=tuple
    )
    """Single values that override the configuration, for example price.in_per_million=0.2."""
    at_once: int | None = None
    """Number of questions at a time; by default 4 to a server, else 1."""
    out: Path | None = None
    """Folder of the results; runs/exam-<model> by default. One that was begun is continued."""


@options
class CompareOptions:
    """The scene, the robot, and how many poses are compared."""

    scene: tyro.conf.Positional[Path]
    """File of the scene, such as …/00802-wcojb4TFT35/wcojb4TFT35.basis.glb."""
    benchmark: BenchmarkName = "hm3d"
    """Published robot whose camera and steps are compared."""
    poses: int = 20
    """Number of random poses."""
    seed: int = 0
    """Seed of the poses."""


@options
class SceneOptions:
    """What to make from a scene: `mesh`, the navigation mesh that habitat-sim would compute."""

    what: tyro.conf.Positional[Literal["mesh"]]
    """mesh"""
    scene: Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="FILE")]
    """File of the scene, such as …/00802-wcojb4TFT35/wcojb4TFT35.basis.glb, or houses:N, …"""
    out: Path
    """File to write, such as wcojb4TFT35.navmesh."""
    radius: float = 0.18
    """Radius of the robot, metres."""
    height: float = 0.88
    """Height of the robot, metres."""


@options
class MemoryOptions:
    """The memory, and what to do with it; without further options a page about it is written."""

    folder: Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="DIR")]
    """Folder of the memory."""
    forget: Annotated[tuple[str, ...] | None, tyro.conf.arg(metavar="NAME [NAME ...]")] = None
    """Names of things to forget, such as cup; all that were seen are forgotten, images stay."""
    forget_images: bool = False
    """Forget all key images."""
    export: Path | None = None
    """GeoJSON file to write with all things; coordinates and heights are metres of the map
    frame."""
    page: Path | None = None
    """HTML file of the page; DIR/index.html by default."""


@options
class ConfigOptions:
    """Which values to list, or where to write their schema."""

    name: Annotated[tyro.conf.Positional[str | None], tyro.conf.arg(metavar="[SECTION]")] = None
    """A section, such as search, or one value, such as search.endurance_steps; by default all."""
    schema: Path | None = None
    """File to write a JSON schema to, by which editors complete and check files for --config."""


@options
class ServeOptions:
    """The address, the access, the agent, and the folder of all searches."""

    host: str = "127.0.0.1"
    """Address to listen on; --token-file is needed unless it is a loopback address."""
    port: int = 8765
    """Port to listen on; 0 takes a free one."""
    token_file: Path | None = None
    """File with a secret that every request must carry: 'Authorization: Bearer SECRET'."""
    state: Path = Path("runs/robot")
    """Folder of all searches; those under way are continued from it after a restart."""
    max_searches: int = 16
    """Maximum number of searches under way at once."""
    idle_minutes: float = 10.0
    """Minutes without a message of its robot after which a search ends."""
    memory: Path | None = None
    """Folder of a memory of the building: searches begin with what earlier ones learned."""
    memory_mb: float | None = None
    """Size of that folder, MB, beyond which the images that tell least are forgotten, from now on;
    at first 50."""
    relocalize: bool = False
    """Let robots turn once around at the start of a search to find out where they are in it: poses
    may be in any frame."""
    who: FlatEmbodiedAgentOptions = field(default_factory=EmbodiedAgentOptions)
    """The options that configure the agents."""


@options
class Episodes:
    """Write the episodes of a split in Habitat's ObjectNav format."""

    split: tyro.conf.Positional[str]
    """A split that hypernav houses splits lists, such as houses-val; -train is for tuning."""
    out: Path
    """File to write (.json.gz or .json), or a folder for a file per building, as in Habitat."""
    houses: str | None = None
    """Only the buildings FIRST:END (END is not included); for an open split any that belong to no
    other."""
    count: int | None = None
    """Number of episodes, counted from the first; all by default."""
    quiet: bool = False
    """Print errors only."""


@options
class Splits:
    """List the splits: their buildings, their number of episodes, and their kind of goals."""


@options
class Export:
    """Write a building as GLB with the files that Habitat needs, or a split as Habitat's data.

    A split is written with its episodes, as one folder that Habitat can use unchanged.
    """

    what: Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="ID|SPLIT")]
    """Number of a house, for example 1234; or offices:N, shops:N, crowded:N, storeys:N; or
    houses-val, or some buildings of a split: houses-val#1000:1004."""
    out: Path | None = None
    """Folder to write to; runs/house-ID, runs/office-ID … by default. Habitat's data folder for a
    split; runs/SPLIT by default."""
    quiet: bool = False
    """Print errors only."""


@options
class Show:
    """Make a page about a building: a view to be turned, plans, images, list of objects."""

    building: Annotated[tyro.conf.Positional[str], tyro.conf.arg(metavar="ID")]
    """Number of a house, for example 1234; or offices:N, shops:N, crowded:N or storeys:N."""
    out: Path | None = None
    """The page (.html), or the folder for it; runs/house-ID, runs/office-ID … by default."""
    quiet: bool = False
    """Print errors only."""


HousesOptions = (
    Annotated[Show, tyro.conf.subcommand("show")]
    | Annotated[Export, tyro.conf.subcommand("export")]
    | Annotated[Episodes, tyro.conf.subcommand("episodes")]
    | Annotated[Splits, tyro.conf.subcommand("splits")]
)
"""One of the subcommands of `hypernav houses`."""


OPTIONS: dict[str, Any] = {
    "find": FindOptions,
    "eval": EvalOptions,
    "ablate": AblateOptions,
    "report": ReportOptions,
    "runs": RunsOptions,
    "doctor": DoctorOptions,
    "exam": ExamOptions,
    "compare": CompareOptions,
    "scene": SceneOptions,
    "memory": MemoryOptions,
    "config": ConfigOptions,
    "serve": ServeOptions,
    "robot": RobotOptions,
    "houses": HousesOptions,
}
"""The options of every command."""
