"""Configuration of simulated robots. It is part of every configuration, and loads no simulator."""

from typing import Literal

from pydantic import Field

from hypernav.core.config import RoomConfig

NavmeshChoice = Literal["auto", "file", "robot"]
"""Navigation mesh that a robot walks on: "auto", the file's if it was made for such a robot, else
one computed as by habitat-sim, also for a generated building whose stairs the robot climbs; "file",
always the file's; or "robot", always a computed one."""

StopChoice = Literal["first_wall", "last_wall"]
"""What ends a step without sliding on a navigation mesh: "first_wall", the first wall that the
straight line crosses, as in habitat-sim 0.3.3 and before; or "last_wall", the last one among the
polygons on the way, as in its tag v0.3.4, which often holds a robot at a wall that it touches."""

RendererName = Literal["cpu", "warp"]
"""What draws a scene: "cpu", a rasterizer on all cores; or "warp", rays on an NVIDIA GPU (extra
``gpu``)."""

Axis = Literal["x", "y", "z", "-x", "-y", "-z"]
"""An axis of a scene's file, in its positive or negative direction."""

CELL_M = 0.05
"""Default side of the walkable surface's cells, metres, as in Habitat's navigation meshes."""


class NoiseConfig(RoomConfig):
    """Kinds and sizes of noise; 0 switches a kind off.

    Realistic values for a RealSense or Kinect on a small robot: ``depth_sigma_m=0.002``,
    ``depth_edge_px=1``, ``forward_sigma=0.02``, ``turn_sigma_deg=1.0``, ``odometry_sigma=0.01``,
    ``odometry_turn_sigma_deg=0.5``.

    Attributes:
        depth_sigma_m: Standard deviation of depth at 1 m; it grows with the square of the distance,
            as for every triangulating sensor.
        depth_edge_px: Pixels without a return on either side of a depth edge.
        forward_sigma: Standard deviation of a forward step, as a share of its length.
        turn_sigma_deg: Standard deviation of a turn, degrees.
        odometry_sigma: Standard deviation of the reported motion, as a share of its length. The
            errors add up: the reported pose drifts from the true one.
        odometry_turn_sigma_deg: Standard deviation of the reported rotation of every motion,
            degrees.
    """

    depth_sigma_m: float = Field(default=0.0, ge=0.0, le=100.0)
    depth_edge_px: int = Field(default=0, ge=0, le=100)
    forward_sigma: float = Field(default=0.0, ge=0.0, le=100.0)
    turn_sigma_deg: float = Field(default=0.0, ge=0.0, le=180.0)
    odometry_sigma: float = Field(default=0.0, ge=0.0, le=100.0)
    odometry_turn_sigma_deg: float = Field(default=0.0, ge=0.0, le=180.0)

    @property
    def is_off(self) -> bool:
        """Whether no kind of noise is switched on."""
        return not (
            self.depth_sigma_m
            or self.depth_edge_px
            or self.forward_sigma
            or self.turn_sigma_deg
            or self.odometry_sigma
            or self.odometry_turn_sigma_deg
        )


class SimulationConfig(RoomConfig):
    """How a robot is simulated.

    Attributes:
        sliding: Slide along obstacles instead of stopping at them; off, as in Habitat's challenges.
        stop_at: Wall that ends a step without sliding on a navigation mesh: "first_wall", as in
            habitat-sim up to 0.3.3, or "last_wall", as since its tag v0.3.4. `--world habitat` goes
            by the habitat-sim that is installed.
        noise: Noise of sensors and motion; none by default.
        labels: Whether observations carry ground-truth labels.
        navmesh: Mesh of a scan: the file's if it was made for such a robot, else one computed as
            by habitat-sim ("auto"); always the file's, also beside an exported house ("file");
            always computed, even if the scene has no file ("robot").
        cell_m: Side of the walkable surface's cells, metres; a navigation mesh has none.
        judge_eye_m: Height above the floor from which a goal must be visible at its view points,
            metres; None takes the camera's. Set it to compare different cameras.
        floor_z: Height of the storey's floor in the scene frame, metres; None takes the main
            storey. A navigation mesh has all storeys.
        file_up: The axis of a scene's file that points up, for a file that is turned otherwise than
            its format says; None believes the format. For your own files, not for scans.
        file_scale: Factor on all lengths of a scene's file, such as 0.001 for millimetres; None
            is 1. For your own files, not for scans.
        renderer: What draws the scene; depth and instances agree, colours differ at edges.
            "warp" needs the extra ``gpu``, and is for a machine with an NVIDIA GPU. habitat-sim
            draws its own images.
    """

    sliding: bool = False
    stop_at: StopChoice = "first_wall"
    noise: NoiseConfig = NoiseConfig()
    labels: bool = True
    navmesh: NavmeshChoice = "auto"
    cell_m: float = Field(default=CELL_M, ge=0.01, le=0.5)
    judge_eye_m: float | None = Field(default=None, gt=0.0, le=10.0)
    floor_z: float | None = Field(default=None, ge=-1000.0, le=1000.0)
    file_up: Axis | None = None
    file_scale: float | None = Field(default=None, ge=1e-6, le=1e6)
    renderer: RendererName = "cpu"
