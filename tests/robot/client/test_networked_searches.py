"""Searches over a real network connection, in this process and between processes."""

import signal
import subprocess
import threading
import time
from contextlib import closing, contextmanager

import numpy as np
import pytest

from box_scenes import room_glb
from hypernav.app.cli.main import main
from hypernav.core.geometry.transforms import Pose2
from hypernav.robot.client.links import HttpLink, HttpServer, ServerAddress, WebSocketLink
from hypernav.robot.client.robot_client import Patience, RobotClient, StopListener
from hypernav.robot.driving.driven_robot import DrivenRobot
from hypernav.robot.simulation.base import SimulatedBase
from hypernav.robot.simulation.faulty_link import FaultyLink, NetworkFaults
from hypernav.robot.wire.replies import SearchEnding
from hypernav.robot.wire.requests import OpenSearch
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer, RenderConfig
from hypernav.simulator.worlds.simulation import SimulatedWorld
from mcap_files import counts_of
from robot_links import StandIn
from rrd_files import images_in
from servers.processes import HYPERNAV, serving_process, simulate
from servers.robots import TOKEN, real_plan, robot_server
from small_episodes import episode_from
from small_worlds import small_config, two_rooms

_FAULTS = NetworkFaults(loss_share=0.2, jitter_s=0.05, duplicate_share=0.2, reorder_share=0.2)


@contextmanager
def simulated_robot():
    scene, config = two_rooms().scene, small_config()
    renderer = CpuRenderer(scene, RenderConfig(threads=1))
    world = SimulatedWorld(scene, config.world, config.embodiment, renderer=renderer)
    with closing(world):
        base = SimulatedBase(world, config.world)
        base.place(episode_from(Pose2(2.0, 1.0, 0.0)), np.random.default_rng(0))
        yield base


@pytest.mark.slow
@pytest.mark.parametrize("kind", [HttpLink, WebSocketLink], ids=["http", "websocket"])
def test_a_search_goes_through_whatever_the_network_does(kind, tmp_path):
    with (
        robot_server(tmp_path, real_plan, token=TOKEN) as plain,
        simulated_robot() as base,
    ):
        address = ServerAddress("127.0.0.1", plain.port, token=TOKEN)
        with closing(HttpServer(address)) as server:
            opened = server.open(OpenSearch(goal="bed", embodiment=base.embodiment, labels=True))
            link = FaultyLink(kind(address, opened.id), _FAULTS, np.random.default_rng(1))
            steps = list(RobotClient(DrivenRobot(base), link))
            assert steps[-1].reply.ending is SearchEnding.FOUND
            traces = list(server.trace(opened.id))
            assert [trace.step for trace in traces] == list(range(len(steps)))
            assert [trace.action for trace in traces] == [step.reply.action for step in steps]
            assert server.grid(opened.id).free.any()
    assert min(link.lost, link.doubled, link.reordered) > 0


@pytest.mark.parametrize("kind", [HttpLink, WebSocketLink])
def test_the_stop_button_of_the_server_ends_the_search(kind, tmp_path):
    with robot_server(tmp_path, real_plan) as plain, simulated_robot() as base:
        address = ServerAddress("127.0.0.1", plain.port)
        with closing(HttpServer(address)) as server:
            opened = server.open(OpenSearch(goal="bed", embodiment=base.embodiment, labels=True))
            client, steps = RobotClient(DrivenRobot(base), kind(address, opened.id)), []
            for step in client:
                steps.append(step)
                if len(steps) == 3:
                    server.stop(opened.id, "enough")
    assert steps[-1].reply.ending is SearchEnding.STOPPED
    assert len(steps) <= 5


def test_the_stop_button_ends_a_motion_under_way(tmp_path):
    """The motion would never end by itself."""
    with robot_server(tmp_path, real_plan) as plain, simulated_robot() as base:
        address = ServerAddress("127.0.0.1", plain.port)
        robot = StandIn(base.embodiment)
        robot.hangs = True
        with closing(HttpServer(address)) as server:
            request = OpenSearch(goal="bed", embodiment=base.embodiment, labels=True)
            opened = server.open(request)
            client = RobotClient(robot, HttpLink(address, opened.id))
            with StopListener(address, opened.id, client.stop):
                search = threading.Thread(target=lambda: list(client))
                search.start()
                assert robot.begun.wait(60.0)
                server.stop(opened.id)
                search.join(60.0)
    assert not search.is_alive()
    assert len(robot.executed) == 1


@pytest.fixture
def served(tmp_path):
    with serving_process(tmp_path / "state") as served:
        yield served


@pytest.mark.slow
def test_a_bad_network_between_processes_keeps_no_bed_from_being_found(
    served, small_house, tmp_path
):
    faults = ("--loss", "0.2", "--jitter", "0.5", "--duplicates", "0.2", "--reordered", "0.2")
    out = tmp_path / "page"
    command = simulate(small_house, served[1], *faults, "--out", str(out))
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr
    assert "found the bed" in done.stderr
    assert (out / "index.html").is_file()


@pytest.mark.slow
def test_a_robot_stands_while_its_server_hangs_and_goes_on_after_it(served):
    process, url = served
    address = ServerAddress.of(url)
    with simulated_robot() as base, closing(HttpServer(address)) as server:
        opened = server.open(OpenSearch(goal="bed", embodiment=base.embodiment, labels=True))
        patience = Patience(deadline_s=0.5, timeout_s=1.0)
        link, steps = HttpLink(address, opened.id), []
        client = RobotClient(DrivenRobot(base), link, continuous=True, patience=patience)
        search = threading.Thread(target=lambda: steps.extend(client))
        search.start()
        while client.steps < 5:
            time.sleep(0.01)
        late = client.watchdog.times_late
        process.send_signal(signal.SIGSTOP)
        while client.watchdog.times_late == late:
            time.sleep(0.01)
        stood_s = base.now_s
        time.sleep(2.0)
        assert base.now_s == stood_s
        assert client.resent > 0
        process.send_signal(signal.SIGCONT)
        search.join(120.0)
    assert steps[-1].reply.ending is SearchEnding.FOUND
    assert [step.reply.sequence for step in steps] == list(range(len(steps)))


@pytest.mark.slow
def test_without_an_address_a_server_is_started_for_the_search(small_house):
    command = [*HYPERNAV, "robot", "simulate", "bed", "--scene", str(small_house)]
    command += ["--start", "4.0", "-1.0", "180"]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.slow
def test_a_search_over_the_network_is_recorded_for_the_viewers(tmp_path):
    glb, out = room_glb(tmp_path / "room.glb"), tmp_path / "out"
    files = ["--mcap", str(tmp_path / "a.mcap"), "--rrd", str(tmp_path / "a.rrd")]
    with robot_server(tmp_path / "state", real_plan) as plain:
        command = simulate(glb, f"http://127.0.0.1:{plain.port}", "--max-steps", "6", *files)
        words = command[len(HYPERNAV) :]
        words[words.index("--start") : words.index("--start") + 4] = []
        for option in ([], ["--out", str(out)]):
            with pytest.raises(SystemExit) as left:
                main([*words, *option, "--quiet"])
            assert left.value.code in (0, 1)
            counts = counts_of(tmp_path / "a.mcap")
            assert 0 < counts["/step"] == counts["/camera/image"] == images_in(tmp_path / "a.rrd")
    assert (out / "trace.jsonl").read_text().count("\n") == counts["/step"]


@pytest.mark.slow
def test_a_server_that_is_not_there_is_an_error_that_names_it(capsys):
    done = subprocess.run(
        [*HYPERNAV, "robot", "simulate", "bed", "--server", "http://127.0.0.1:9"],
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )
    assert done.returncode == 2
    assert "127.0.0.1:9" in done.stderr
