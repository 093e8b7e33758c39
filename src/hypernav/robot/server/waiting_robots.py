"""Robots that wait for a goal, and the goals that they are given."""

import secrets
import time
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

from hypernav.core.errors import RequestRefusedError
from hypernav.core.goal import Goal
from hypernav.robot.server.searches.threads import Bell
from hypernav.robot.wire.requests import GivenGoal, ThingName, WaitingRobot

_MOST_ROBOTS = 100
_MOST_WITHDRAWN = 1000
_FORGOTTEN_S = 10.0
"""Time without a request after which a robot no longer waits, and its goal lapses, seconds."""


@dataclass
class _Robot:
    heard_s: float
    asking: int = 0
    given: GivenGoal | None = None
    thing: ThingName | None = None
    refused: str = ""


class WaitingRobots:
    """The waiting robots and their goals. Not thread-safe: only the server's event loop uses it.

    Attributes:
        bell: Bell that rings when a goal is given.
    """

    def __init__(self) -> None:
        """Create it; no robot is waiting."""
        self.bell = Bell()
        self._robots: dict[str, _Robot] = {}
        self._withdrawn: deque[str] = deque(maxlen=_MOST_WITHDRAWN)

    def all(self) -> list[WaitingRobot]:
        """The robots that wait, by name."""
        self._forget()
        found = sorted(self._robots.items())
        return [
            WaitingRobot(name=name, given=robot.given, refused=robot.refused)
            for name, robot in found
        ]

    async def wait(self, name: str, wait_s: float) -> GivenGoal:
        """Let a robot wait for a goal, up to a time limit.

        Raises:
            RequestRefusedError: Too many robots are waiting.
        """
        with self._asking(name) as robot:
            await self.bell.until(lambda: robot.given is not None, wait_s)
            return robot.given or GivenGoal()

    def give(self, name: str, goal: Goal, thing: ThingName | None = None) -> GivenGoal:
        """Give a goal to a robot that waits.

        Args:
            name: The robot.
            goal: What to find.
            thing: The remembered thing that is meant; None if any will do.

        Raises:
            RequestRefusedError: It is not waiting, or has a goal already.
        """
        self._forget()
        robot = self._robots.get(name)
        if robot is None:
            raise RequestRefusedError(
                f"no robot {name} waits for a goal", error="unknown", status=404
            )
        if robot.given is not None:
            raise RequestRefusedError(
                f"{name} was told to find {robot.given.goal} just now; press STOP to withdraw it",
                error="busy",
                status=409,
            )
        robot.given, robot.refused = GivenGoal(goal=goal.text, key=secrets.token_hex(16)), ""
        robot.thing = thing
        self.bell.ring()
        return robot.given

    def meant(self, key: str | None) -> ThingName | None:
        """The remembered thing that is meant by the goal with a key; None if any will do."""
        for robot in self._robots.values():
            if robot.given is not None and robot.given.key == key:
                return robot.thing
        return None

    def take_up(self, key: str | None) -> bool:
        """Note that a search was opened with a key.

        Returns:
            Whether it may go on, because its goal was not withdrawn.
        """
        for name, robot in list(self._robots.items()):
            if robot.given is not None and robot.given.key == key:
                del self._robots[name]
        return key not in self._withdrawn

    def refuse(self, key: str | None, reason: str) -> None:
        """Withdraw a goal for which no search could be opened.

        Args:
            key: Key of the search.
            reason: Why, for the operator.
        """
        for robot in self._robots.values():
            if robot.given is not None and robot.given.key == key:
                robot.given, robot.refused = None, reason

    def withdraw_all(self) -> None:
        """Withdraw every goal that no robot has taken up yet."""
        for robot in self._robots.values():
            if robot.given is not None and robot.given.key is not None:
                self._withdrawn.append(robot.given.key)
                robot.given = None

    @contextmanager
    def _asking(self, name: str) -> Iterator[_Robot]:
        self._forget()
        robot = self._robots.setdefault(name, _Robot(time.monotonic()))
        if len(self._robots) > _MOST_ROBOTS:
            del self._robots[name]
            raise RequestRefusedError(
                f"{_MOST_ROBOTS} robots wait, as many as there may be", error="busy", status=429
            )
        robot.asking += 1
        try:
            yield robot
        finally:
            robot.asking -= 1
            robot.heard_s = time.monotonic()

    def _forget(self) -> None:
        oldest_s = time.monotonic() - _FORGOTTEN_S
        for name, robot in list(self._robots.items()):
            if robot.asking == 0 and robot.heard_s < oldest_s:
                del self._robots[name]
