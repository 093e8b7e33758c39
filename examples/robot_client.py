"""Connect a robot of your own: three methods that you write, and a search drives it.

`Robot` asks for `observe`, `execute` and `stop`. Everything else (numbers, lost answers, the
watchdog, the stop button) is the client's. The robot here is a stand-in in a room with a door; put
your camera, your odometry and your wheels in its place. If it takes velocities, write a
`hypernav.Base` instead: `hypernav.DrivenRobot` then also stops for people.

Run: hypernav serve, then in another terminal: python examples/robot_client.py http://127.0.0.1:8765
Without an address it starts a server itself, for as long as it runs.
"""

import re
import subprocess
import sys
import tempfile
import time
from contextlib import closing, contextmanager

from hypernav import (
    Action,
    BoxRoom,
    Embodiment,
    Executed,
    HttpLink,
    HttpServer,
    OpenSearch,
    RobotClient,
    Sensed,
    ServerAddress,
    StopListener,
)


class MyRobot:
    """Your robot: replace the room by your hardware."""

    def __init__(self) -> None:
        self._hardware = BoxRoom()

    @property
    def embodiment(self) -> Embodiment:
        # Body, camera and actions: metres and degrees.
        return self._hardware.embodiment

    def observe(self) -> Sensed:
        # Colour (RGB), depth in metres (0: no return), pose by odometry (x forward, y left), time.
        seen = self._hardware.observe()
        # A real robot has no true labels; its server needs --vlm, or a detector.
        return Sensed(seen.rgb, seen.depth, seen.robot, time.monotonic(), truth=seen.truth)

    def execute(self, action: Action) -> Executed:
        # Drive one step or turn, and return when it is done.
        self._hardware.step(action)
        return Executed.DONE

    def stop(self) -> None:
        # Command standstill; may be called from another thread at any time.
        pass


def search(url: str) -> None:
    robot, address = MyRobot(), ServerAddress.of(url)
    with closing(HttpServer(address)) as server:
        opened = server.open(OpenSearch(goal="door", embodiment=robot.embodiment, labels=True))
        client = RobotClient(robot, HttpLink(address, opened.id))
        with StopListener(address, opened.id, client.stop):
            for step in client:
                print(f"{step.reply.sequence:3d} {step.reply.mode}: {step.reply.reason}")
        print(f"the search ended: {server.status(opened.id).ending}")


@contextmanager
def own_server():
    main = "from hypernav.app.cli.main import main; main()"
    with tempfile.TemporaryDirectory() as state:
        command = [sys.executable, "-c", main, "serve", "--port", "0", "--state", state]
        server = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
        assert server.stderr is not None
        try:
            found = next(filter(None, (re.search("http://[^,]+", line) for line in server.stderr)))
            yield found[0]
        finally:
            server.terminate()
            server.communicate()


def main() -> None:
    if len(sys.argv) > 1:
        search(sys.argv[1])
        return
    with own_server() as url:
        search(url)


if __name__ == "__main__":
    main()
