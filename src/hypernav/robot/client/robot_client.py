"""A robot's side of a search: observe, ask, execute once, go on; and stand still in time.

A watchdog halts a robot whose answer is late, and a stop listener lets the server's stop button
take effect in the middle of a motion.
"""

import logging
import math
import threading
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Generator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from types import TracebackType

from hypernav.core.embodiment import Action
from hypernav.core.errors import (
    ContractError,
    LinkLostError,
    RequestRefusedError,
    RobotLinkError,
    SensorError,
    ServerUnreachableError,
)
from hypernav.core.geometry.transforms import Pose2, Transform, wrap_angle
from hypernav.robot.client.links import HttpServer, Link, ServerAddress, failure_words, give_up
from hypernav.robot.client.robot import Executed, FollowsPaths, Robot, Sensed
from hypernav.robot.wire.frames import pack_observation
from hypernav.robot.wire.replies import Reply, SearchEnding
from hypernav.robot.wire.requests import ObservationFacts
from hypernav.robot.wire.values import PlanarPose, RigidMatrix

_LOG = logging.getLogger(__name__)


class SideThread(ABC):
    """Does its work in a thread of its own while a ``with`` block runs, and ends with it.

    The block may wait for the network, or hang; the thread goes on.
    """

    def __enter__(self) -> None:
        """Start the thread."""
        self._block_ended = threading.Event()
        self._thread = threading.Thread(
            target=self._work_until, args=(self._block_ended,), daemon=True
        )
        self._thread.start()

    def __exit__(self, *error: object) -> None:
        """Wait until the work has ended."""
        self._block_ended.set()
        self._thread.join()

    @abstractmethod
    def _work_until(self, block_ended: threading.Event) -> None:
        """Do the work; return soon after the block has ended."""


class Watchdog(SideThread):
    """Calls a function if a ``with`` block takes too long, while the block goes on.

    The function has returned before the block ends, so it cannot stop the motion that comes next.

    Attributes:
        times_late: Number of blocks that took too long.

    Examples:
        >>> with Watchdog(0.5, robot.stop):  # doctest: +SKIP
        ...     reply = link.ask(body, sequence, timeout_s=5.0)
    """

    def __init__(
        self,
        deadline_s: float,
        on_late: Callable[[], None],
        *,
        wait: Callable[[threading.Event, float], bool] = threading.Event.wait,
    ) -> None:
        """Create it.

        Args:
            deadline_s: Time after which it acts, seconds.
            on_late: Function to call, for example `hypernav.robot.client.robot.Robot.stop`.
            wait: Function that waits some seconds for an event, and says whether it came.
        """
        self._deadline_s = deadline_s
        self._on_late = on_late
        self._wait = wait
        self.times_late: int = 0

    def _work_until(self, block_ended: threading.Event) -> None:
        if not self._wait(block_ended, self._deadline_s):
            self.times_late += 1
            self._on_late()


_WAIT_S = 1.0
_PAUSE_S = 0.2
_OUTSIDE = frozenset({SearchEnding.STOPPED, SearchEnding.CLOSED, SearchEnding.ROBOT_FAILED})
"""Endings that come while the robot may be in the middle of a motion."""


class StopListener(SideThread):
    """Waits beside a search until someone presses stop, over a connection of its own.

    It ends at most a second after the ``with`` block. If the block ends by an error, the server is
    told, so that its operator reads why.

    Examples:
        >>> with StopListener(address, opened.id, client.stop):  # doctest: +SKIP
        ...     for step in client:
        ...         print(step.reply.reason)
    """

    def __init__(self, address: ServerAddress, search_id: str, on_stop: Callable[[], None]) -> None:
        """Create it; it listens within a ``with`` block.

        Args:
            address: The server.
            search_id: The search.
            on_stop: Function to call, once, for example `RobotClient.stop`.
        """
        self._address = address
        self._server = HttpServer(address)
        self._search_id = search_id
        self._on_stop = on_stop

    def __exit__(self, *raised: object) -> None:
        """Wait until the work has ended, and tell the server of an error."""
        super().__exit__(*raised)
        error = next((one for one in raised if isinstance(one, BaseException)), None)
        if error is not None and not isinstance(error, RobotLinkError):
            give_up(self._address, self._search_id, failure_words(error))

    def _work_until(self, block_ended: threading.Event) -> None:
        version = -1
        while not block_ended.is_set():
            try:
                status = self._server.status(self._search_id, after=version, wait_s=_WAIT_S)
            except (RobotLinkError, RequestRefusedError):
                block_ended.wait(_PAUSE_S)  # the search itself notices what is wrong
                version = -1  # a restarted server counts its versions from the beginning
                continue
            version = status.version
            if status.ending in _OUTSIDE:
                self._on_stop()
            if status.ending is not None:
                break
        self._server.close()


MADE_SHARE = 0.6
"""Share of a motion below which it did not happen; agents detect a bump by the same share."""
_FIRST_PAUSE_S, _LONGEST_PAUSE_S = 0.05, 2.0
"""First and longest pause between attempts; each is twice the one before."""


@dataclass(frozen=True, eq=False)
class ClientStep:
    """One step of a search, as the robot saw it.

    Attributes:
        sensed: What the robot sensed.
        reply: What the server answered.
        executed: What became of the action; None for the last step.
        blocked: Whether the motion before this step did not happen.
    """

    sensed: Sensed
    reply: Reply
    executed: Executed | None
    blocked: bool


@dataclass(frozen=True)
class Patience:
    """How long a client waits for what.

    Attributes:
        deadline_s: Wait for an answer after which the robot stands still, seconds.
        timeout_s: Wait for an answer after which the same observation is sent again, seconds.
        unreachable_s: Time without any answer after which the search is given up, seconds.
    """

    deadline_s: float = 0.5
    timeout_s: float = 5.0
    unreachable_s: float = 60.0


class RobotClient:
    """Drives a robot by the answers of a server; each answer is executed at most once.

    A lost observation is sent again with the same number, and the server gives the same answer.
    While an answer is late the robot stands still. `stop` overrides everything.

    Attributes:
        steps: Number of answers so far.
        blocked: Number of motions that did not happen.
        resent: Number of observations that were sent again.
        watchdog: Watchdog that stops the robot while an answer is late.

    Examples:
        >>> client = RobotClient(robot, HttpLink(address, opened.id))  # doctest: +SKIP
        >>> for step in client:  # doctest: +SKIP
        ...     print(step.reply.reason)
    """

    def __init__(
        self,
        robot: Robot,
        link: Link,
        *,
        next_sequence: int = 0,
        continuous: bool = False,
        patience: Patience | None = None,
    ) -> None:
        """Create it; iterating runs the search.

        Args:
            robot: The robot.
            link: Link to one search of the server.
            next_sequence: Number of the first observation, as the server expects it.
            continuous: Whether to drive smoothly along paths, as a robot with `FollowsPaths` can.
            patience: How long to wait for what.
        """
        self._robot = robot
        self._follower = robot if continuous and isinstance(robot, FollowsPaths) else None
        self._link = link
        self._sequence = next_sequence
        self._patience = patience or Patience()
        self._stopped, self._moving = threading.Event(), threading.Event()
        self.watchdog: Watchdog = Watchdog(self._patience.deadline_s, robot.stop)
        self.steps: int = 0
        self.blocked: int = 0
        self.resent: int = 0

    def __iter__(self) -> Generator[ClientStep, None, None]:
        """Run the search to its end, one step at a time; the robot stands still after it.

        Whatever ends it but an answer of the server is told to the server, for its operator.

        Raises:
            ServerUnreachableError: No answer for too long.
            RequestRefusedError: The server refuses what this robot sends.
            SensorError: What the robot senses cannot be right, as the server or `Sensed` says.
        """
        last: ClientStep | None = None
        with ExitStack() as end:  # at the end the robot stops first
            end.callback(self._link.close)
            pool = ThreadPoolExecutor(1)
            end.callback(pool.shutdown)
            end.push(self._tell_failure)
            end.callback(self._robot.stop)
            end.callback(self._stopped.set)  # ends the attempts of the thread in the pool
            while not self._stopped.is_set():
                sensed = _sensed(self._robot)
                blocked = last is not None and self._failed(last, sensed.odometry)
                with self.watchdog:
                    answer = pool.submit(self._answer, sensed, blocked)
                    self._roll_on(last, answer)
                    reply = answer.result()
                executed = None
                if not (reply.done or reply.action in (None, Action.STOP)):
                    executed = self._execute(reply, sensed)
                self.steps += 1
                self.blocked += blocked
                last = ClientStep(sensed, reply, executed, blocked)
                yield last
                if reply.ending is SearchEnding.ROBOT_FAILED:
                    raise SensorError(reply.reason)
                if executed is None:
                    return

    def _tell_failure(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Tell the server by what the iteration ended, unless the caller just leaves its loop."""
        if kind is not None and not issubclass(kind, GeneratorExit | ServerUnreachableError):
            self._link.give_up(failure_words(error))

    def stop(self) -> None:
        """Stop the robot permanently, from any thread; returns when it stands still.

        The server is not told; `hypernav.robot.client.links.HttpServer.stop` does that.
        """
        self._stopped.set()
        self._robot.stop()
        # A motion may begin just now: stop it again until it has ended.
        while self._moving.is_set():
            time.sleep(0.01)
            self._robot.stop()

    def _execute(self, reply: Reply, sensed: Sensed) -> Executed:
        """Execute the action of a reply, once."""
        if self._follower is None or not self._leads_on(reply):
            return self._moved(lambda: self._robot.execute(Action(reply.action or 0)))
        follow, start = self._follower.follow, sensed.odometry
        path = _in_odometry(reply.path, sensed.odom_to_map)
        forward_m = self._robot.embodiment.motion.forward_m
        return self._moved(
            lambda: follow(path, lambda robot: start.distance_to(*robot.xy) >= forward_m)
        )

    def _roll_on(self, last: ClientStep | None, answer: Future[Reply]) -> None:
        """Drive on along the previous path until there is an answer, or it is late."""
        if self._follower is None or last is None or last.executed is not Executed.DONE:
            return
        if self._leads_on(last.reply):
            follow = self._follower.follow
            path = _in_odometry(last.reply.path, last.sensed.odom_to_map)
            self._moved(lambda: follow(path, lambda _: answer.done()))

    def _leads_on(self, reply: Reply) -> bool:
        """Whether a robot can drive along a reply's path instead of making a step.

        The path must end beyond the step: an agent takes a shorter motion for a bump.
        """
        path, forward_m = reply.path, self._robot.embodiment.motion.forward_m
        is_ahead = len(path) > 1 and math.dist(path[0], path[-1]) >= forward_m
        return reply.action is Action.MOVE_FORWARD and is_ahead

    def _moved(self, motion: Callable[[], Executed]) -> Executed:
        """Make a motion, unless stop was pressed."""
        self._moving.set()
        try:
            executed = Executed.STOPPED if self._stopped.is_set() else motion()
        finally:
            self._moving.clear()
        if not isinstance(executed, Executed):
            raise ContractError(
                f"{type(self._robot).__name__}: a motion returned {executed!r}; expected "
                "Executed.DONE, Executed.BLOCKED or Executed.STOPPED"
            )
        return executed

    def _failed(self, last: ClientStep, now: Pose2) -> bool:
        """Whether a motion did not happen: the robot says so, or its odometry does."""
        if last.executed is Executed.BLOCKED:
            return True
        before, motion = last.sensed.odometry, self._robot.embodiment.motion
        if last.reply.action is Action.MOVE_FORWARD:
            return before.distance_to(*now.xy) < MADE_SHARE * motion.forward_m
        turned = abs(wrap_angle(now.yaw - before.yaw))
        return turned < MADE_SHARE * math.radians(motion.turn_angle_deg)

    def _answer(self, sensed: Sensed, blocked: bool) -> Reply:
        """The decision about an observation, which is sent as often as necessary."""
        facts = ObservationFacts(
            sequence=self._sequence,
            stamp_s=sensed.stamp_s,
            base_to_odom=_pose(sensed.odometry, sensed.height_m),
            odom_to_map=_pose(sensed.odom_to_map),
            camera_to_base=_matrix(sensed.camera_to_base),
            blocked=blocked,
        )
        body = pack_observation(facts, sensed.rgb, sensed.depth, sensed.truth)
        reply = self._decided(body)
        self._sequence += 1
        return reply

    def _decided(self, body: bytes) -> Reply:
        """The reply to an observation, which is sent again if lost; waits while it is on hold."""
        pause_s, is_known = _FIRST_PAUSE_S, False
        given_up_s = time.monotonic() + self._patience.unreachable_s
        while True:
            try:
                ask = self._link.ask_again if is_known else partial(self._link.ask, body)
                reply = ask(self._sequence, self._patience.timeout_s)
                if (reply.sequence == self._sequence and not reply.hold) or reply.done:
                    return reply
                is_known, pause_s = reply.hold, _FIRST_PAUSE_S
                # The server is reachable; it only needs time to decide.
                given_up_s = time.monotonic() + self._patience.unreachable_s
            except LinkLostError as error:
                _LOG.info("observation %d is sent again: %s", self._sequence, error)
                is_known, lost = False, error
            except RequestRefusedError as error:
                is_known, lost = self._taken(error), error
            else:
                continue
            if self._stopped.is_set() or time.monotonic() > given_up_s:
                raise ServerUnreachableError(
                    f"no answer to observation {self._sequence} for "
                    f"{self._patience.unreachable_s:g} s ({lost}); the robot stands still. Is the "
                    "server running? Opened again with the same key, the search goes on once it is"
                ) from lost
            self.resent += 1
            time.sleep(pause_s)
            pause_s = min(2.0 * pause_s, _LONGEST_PAUSE_S)

    def _taken(self, refusal: RequestRefusedError) -> bool:
        """Whether the server has the observation although it refused this copy.

        A late copy of an earlier observation is refused with the number that is expected now. A
        server that is busy or starts again says so, too.

        Raises:
            RequestRefusedError: The server will never take it.
        """
        if refusal.error == "pending":
            return True
        if refusal.error == "sequence" and refusal.expected in (
            self._sequence,
            self._sequence + 1,
        ):
            return refusal.expected == self._sequence + 1
        if refusal.status in (429, 503):
            return False
        raise refusal


def _sensed(robot: Robot) -> Sensed:
    """What a robot senses now.

    Raises:
        ContractError: It is something else.
    """
    sensed = robot.observe()
    if not isinstance(sensed, Sensed):
        raise ContractError(
            f"{type(robot).__name__}: observe returned {sensed!r:.60}; expected a Sensed"
        )
    return sensed


def _in_odometry(
    path: Sequence[tuple[float, float]], odom_to_map: Pose2
) -> list[tuple[float, float]]:
    """A path of the ``map`` frame in the frame of the odometry, which doesn't jump."""
    c, s = math.cos(odom_to_map.yaw), math.sin(odom_to_map.yaw)
    offsets = [(x - odom_to_map.x, y - odom_to_map.y) for x, y in path]
    return [(c * x + s * y, c * y - s * x) for x, y in offsets]


def _matrix(transform: Transform | None) -> RigidMatrix | None:
    if transform is None:
        return None
    a, b, c, d = (tuple(row) for row in transform.matrix.tolist())
    return (a, b, c, d)


def _pose(pose: Pose2, height_m: float = 0.0) -> PlanarPose:
    return PlanarPose(x=pose.x, y=pose.y, yaw=pose.yaw, z=height_m)
