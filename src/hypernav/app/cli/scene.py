"""The command `hypernav scene`: the navigation mesh of a scene."""

from hypernav.app.build.data.scenes import load_scene
from hypernav.app.cli.guards.crashes import ExitStatus
from hypernav.app.cli.guards.outputs import check_file
from hypernav.app.cli.options.commands import SceneOptions
from hypernav.app.cli.screen.terminal import Terminal
from hypernav.core.config import check_option
from hypernav.core.embodiment import BodyConfig
from hypernav.core.errors import OutputError
from hypernav.io.writing import write_whole
from hypernav.simulator.worlds.navmesh.navmesh import Navmesh
from hypernav.simulator.worlds.navmesh.navmesh_reader import navmesh_of
from hypernav.simulator.worlds.navmesh.robot_navmesh import computed_for


def run(options: SceneOptions) -> int:
    """Run the command.

    Returns:
        The status of success.

    Raises:
        NavmeshError: The robot fits nowhere, or the scene is too large.
        OutputError: The file can't be written.
        SceneError: The scene is missing or can't be opened.
    """
    check_option("--radius", options.radius, (0.0, 5.0), "radius of the robot, metres")
    check_option("--height", options.height, (0.2, 10.0), "height of the robot, metres")
    check_file(options.out)
    console = Terminal(stderr=False, soft_wrap=True)
    body = BodyConfig(radius_m=options.radius, height_m=options.height)
    with console.status("computing the mesh …"):
        content = computed_for(load_scene(options.scene), body)
    navmesh = Navmesh(navmesh_of(content))
    try:
        options.out.parent.mkdir(parents=True, exist_ok=True)
        write_whole(options.out, content)
    except OSError as error:
        raise OutputError(f"{options.out} cannot be written ({error.strerror})") from error
    walkable = navmesh.areas_m2[navmesh.areas_m2 > 0.0]
    console.print(
        f"{options.out}: {navmesh.area_m2:.1f} m² in {len(walkable)} parts, "
        f"{len(navmesh.islands)} polygons, for a robot of radius {options.radius:g} m and height "
        f"{options.height:g} m",
        markup=False,
    )
    return ExitStatus.SUCCESS
