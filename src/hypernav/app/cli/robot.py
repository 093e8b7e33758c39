"""The command `hypernav robot`: robots, simulated or on ROS 2, recordings, and field studies.

Here are its options, and the choice of the module that runs a subcommand.
"""

import importlib
from dataclasses import field
from pathlib import Path
from typing import Annotated, Literal

import tyro

from hypernav.app.build.components.component_specs import RobotPresetName
from hypernav.app.cli.options.agent import (
    EmbodiedAgentOptions,
    FlatEmbodiedAgentOptions,
    FlatRobotViewOptions,
    RobotViewOptions,
)
from hypernav.app.cli.options.declaring import options


@options
class Simulate:
    """Let a simulated robot search over the network, with the answers of `hypernav serve`."""

    goal: tyro.conf.Positional[str]
    """The object to find: bed, "L-shaped sofa", …"""
    server: str | None = None
    """Address of the server, for example http://127.0.0.1:8765; else one is started for the
    search."""
    scene: str = "builtin"
    """The building: builtin, houses:N, offices:N, shops:N, crowded:N or storeys:N, or the file of a
    scene."""
    token_file: Path | None = None
    """File with the server's secret."""
    link: Literal["http", "websocket"] = "http"
    """Transport of the observations: one HTTP request each, or one WebSocket for all."""
    motion: Literal["steps", "continuous"] = "steps"
    """Steps and turns one by one, or smooth driving along the path."""
    agent: str | None = None
    """Agent, such as frontier; the server's by default."""
    preset: RobotPresetName | None = None
    """Values of the method; the server's by default."""
    start: Annotated[tuple[float, ...] | None, tyro.conf.arg(metavar="X Y YAW [Z]")] = None
    """Start pose in the scene: metres, and degrees counter-clockwise from x; then the height of its
    floor in metres, where it isn't the main one. Random by default."""
    seed: int = 0
    """Seed of the random start, of all noise and of all faults."""
    max_steps: int = 500
    """Maximum number of observations."""
    noise: bool = False
    """Noise of a real depth camera, of wheels and of odometry that drifts."""
    localisation: float | None = None
    """Error of a localisation that jumps at every observation, metres, instead of drift."""
    stuck: float = 0.0
    """Share of the motions during which the wheels don't turn."""
    person: bool = False
    """Whether a person steps into the robot's way from time to time."""
    loss: float = 0.0
    """Share of the messages that get lost."""
    jitter: float = 0.0
    """Largest delay of a message, seconds."""
    duplicates: float = 0.0
    """Share of the observations that arrive twice."""
    reordered: float = 0.0
    """Share of the observations after which an earlier one arrives."""
    config: Path | None = None
    """YAML file with the sections embodiment and world."""
    set: Annotated[tuple[str, ...], tyro.conf.arg(metavar="SECTION.KEY=VALUE")] = field(
        default_factory=tuple
    )
    """Single values of these sections, for example embodiment.camera.width=320."""
    out: Path | None = None
    """Folder of the page about the search; none by default."""
    views: FlatRobotViewOptions = field(default_factory=RobotViewOptions)
    """The options that choose views."""
    quiet: bool = False
    """Print errors only."""


@options
class Wait:
    """Let a simulated robot wait for goals from the operator's page of `hypernav serve`."""

    server: str
    """Address of the server, for example http://127.0.0.1:8765."""
    name: str = "simulated"
    """The robot's name on the page."""
    scene: str = "builtin"
    """The building: builtin, houses:N, offices:N, shops:N, crowded:N or storeys:N, or the file of a
    scene."""
    token_file: Path | None = None
    """File with the server's secret."""
    agent: str | None = None
    """Agent, such as frontier; the server's by default."""
    preset: RobotPresetName | None = None
    """Values of the method; the server's by default."""
    start: Annotated[tuple[float, ...] | None, tyro.conf.arg(metavar="X Y YAW [Z]")] = None
    """First start pose in the scene: metres, and degrees counter-clockwise from x; then the height
    of its floor in metres, where it isn't the main one. Random by default."""
    seed: int = 0
    """Seed of the random start."""
    config: Path | None = None
    """YAML file with the sections embodiment and world."""
    set: Annotated[tuple[str, ...], tyro.conf.arg(metavar="SECTION.KEY=VALUE")] = field(
        default_factory=tuple
    )
    """Single values of these sections, for example embodiment.camera.width=320."""
    quiet: bool = False
    """Print errors only."""


@options
class Ros2:
    """Search on a robot that speaks ROS 2, over DDS and without ROS (extra ros2)."""

    goal: tyro.conf.Positional[str]
    """The object to find: bed, "L-shaped sofa", …"""
    config: Path | None = None
    """YAML file about the robot: topics, frames, timing, speed, embodiment (docs/ros2.md)."""
    set: Annotated[tuple[str, ...], tyro.conf.arg(metavar="SECTION.KEY=VALUE")] = field(
        default_factory=tuple
    )
    """Single values of it, for example topics.cmd_vel=/robot1/cmd_vel."""
    server: str | None = None
    """Address of hypernav serve, which has the model; else one is started for the search."""
    token_file: Path | None = None
    """File with the server's secret."""
    vlm: str | None = None
    """Model of the server that is started, as for hypernav serve."""
    detector: str | None = None
    """Its detector, instead of --vlm: yolox:PATH.onnx, picodet:PATH.onnx, …"""
    reasoner: str | None = None
    """Its component that says where to go, instead of --vlm: geometric, …"""
    drive: Literal["cmd_vel", "nav2"] = "cmd_vel"
    """What drives the robot: hypernav by velocities, or a running Nav2 by goals."""
    motion: Literal["steps", "continuous"] | None = None
    """Steps and turns one by one, or smooth driving along the path; steps by default, continuous
    with --drive nav2."""
    agent: str | None = None
    """Agent, such as frontier; the server's by default."""
    preset: RobotPresetName | None = None
    """Values of the method; the server's by default."""
    max_steps: int = 500
    """Maximum number of observations."""
    out: Path | None = None
    """Folder of the page about the search; none by default."""
    views: FlatRobotViewOptions = field(default_factory=RobotViewOptions)
    """The options that choose views."""
    quiet: bool = False
    """Print errors only."""

    @property
    def is_continuous(self) -> bool:
        """Whether the robot follows paths smoothly."""
        return (self.motion or ("continuous" if self.drive == "nav2" else "steps")) == "continuous"

    @property
    def own_server(self) -> list[str]:
        """The options of the server that is started for the search."""
        named = {"--vlm": self.vlm, "--detector": self.detector, "--reasoner": self.reasoner}
        return [word for name, value in named.items() if value for word in (name, value)]


@options
class Replay:
    """Process recorded RGB-D frames as on a robot: draw the map, look for the goal."""

    recording: tyro.conf.Positional[Path]
    """A bag of ROS 1 or ROS 2, or a folder of 3DMatch, 7-Scenes, TUM RGB-D or ScanNet."""
    goal: str | None = None
    """The object to look for; needs --detector or --vlm."""
    who: FlatEmbodiedAgentOptions = field(default_factory=EmbodiedAgentOptions)
    """The options that configure the agent."""
    every: int = 1
    """Take every n-th frame only."""
    colour_topic: str | None = None
    """Topic of the colour images in a bag with several cameras."""
    depth_topic: str | None = None
    """Topic of the depth images, registered to colour."""
    camera_info_topic: str | None = None
    """Topic of the colour images' calibration."""
    depth_per_metre: float | None = None
    """Depth value of one metre: by default 5000 in TUM RGB-D, 1000 in others, 1 in 32FC1."""
    out: Path | None = None
    """Folder of the results; runs/<time>-<recording> by default."""
    record: Path | None = None
    """File that records every exchange with the model of --vlm, for --vlm replay:FILE."""
    views: FlatRobotViewOptions = field(default_factory=RobotViewOptions)
    """The options that choose views."""
    quiet: bool = False
    """Print errors only."""


@options
class Report:
    """Success and SPL of finished searches, per goal and method, as in the paper's last table."""

    searches: tyro.conf.Positional[tuple[Path, ...]]
    """Folders of finished searches, each with a file trial.yaml of hand measurements."""
    csv: Path | None = None
    """File for the table as CSV."""
    quiet: bool = False
    """Print errors only."""


RobotOptions = (
    Annotated[Simulate, tyro.conf.subcommand("simulate")]
    | Annotated[Wait, tyro.conf.subcommand("wait")]
    | Annotated[Ros2, tyro.conf.subcommand("ros2")]
    | Annotated[Replay, tyro.conf.subcommand("replay")]
    | Annotated[Report, tyro.conf.subcommand("report")]
)
"""One of the subcommands of `hypernav robot`."""


_MODULES = {
    Simulate: "simulate",
    Wait: "wait",
    Ros2: "ros2",
    Replay: "replay",
    Report: "report",
}


def run(options: Simulate | Wait | Ros2 | Replay | Report) -> int:
    """Run a subcommand.

    Returns:
        Its exit status.
    """
    name = _MODULES[type(options)]
    return importlib.import_module(f"hypernav.app.cli.robots.{name}").run(options)
