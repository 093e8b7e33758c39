"""The messages between a waiting robot and an operator who gives it a goal.

1. The robot asks ``POST /v1/robots/NAME/wait`` again and again; each request is answered by a
   `GivenGoal`, at the latest after a few seconds.
2. The operator sees it in ``GET /v1/robots`` and gives it a `GoalRequest` by
   ``POST /v1/robots/NAME/goal``.
3. The robot opens a search for this goal with this key, as for a goal of its own. Until then it
   gets the same goal again, so a lost answer loses nothing.

``POST /v1/stop`` withdraws goals that are not taken up yet, and stops every search. A search that
is opened with the key of a withdrawn goal is stopped before it begins.
"""

import re
from typing import Annotated

from pydantic import Field

from hypernav.core.goal import MAX_GOAL_LENGTH
from hypernav.robot.wire.requests import ThingName
from hypernav.robot.wire.values import Message

THINGS = "/v1/things"
"""Path of the things that the server's memory knows."""
ROBOTS = "/v1/robots"
"""Path of the robots that wait; that of one is ``ROBOTS/NAME``."""
STOP_ALL = "/v1/stop"
"""Path of the button that stops every robot."""
LONGEST_WAIT_FOR_GOAL_S = 10.0
"""Longest time that the server keeps a robot without a goal waiting, seconds."""
ROBOT_NAME = r"^[A-Za-z0-9][A-Za-z0-9_-]{0,39}$"
"""Names of robots: up to 40 letters, digits, ``_`` and ``-``."""


def is_robot_name(name: str) -> bool:
    """Whether a robot may have this name."""
    return re.fullmatch(ROBOT_NAME, name) is not None


class GoalRequest(Message):
    """What a robot is to find.

    Attributes:
        goal: What to find, as text.
        thing: The remembered thing that is meant; None if any will do.
    """

    goal: Annotated[str, Field(min_length=1, max_length=MAX_GOAL_LENGTH)]
    thing: ThingName | None = None


class GivenGoal(Message):
    """The answer to a robot that waits.

    Attributes:
        goal: What to find; None as long as no goal was given.
        key: The ``key`` to open the search with; it also tells the server which thing is meant.
    """

    goal: str | None = None
    key: str | None = None


class RememberedThing(Message):
    """A thing of the server's memory.

    Attributes:
        thing: Its name, to be given to a robot as a goal.
        label: The detector's word for it.
        position: Its middle ``(x, y, z)``, ``map`` frame, heights above the floor, metres.
        chance: Chance that it is what it was taken for and still there, 0 to 1.
        no_way: That a robot on the floor where the last search ended knows no stairs to the floor
            of the thing, or climbs none, for people; else empty. No reason to refuse it as a goal:
            another robot, or one that was carried, may be on that floor. A server whose plan goes
            over no stairs (`search.use_stairs`) has no way to any other floor.
    """

    thing: ThingName
    label: str
    position: tuple[float, float, float]
    chance: float
    no_way: str = ""


class WaitingRobot(Message):
    """A robot that waits for a goal.

    Attributes:
        name: Name that the robot gave itself.
        given: Goal for which it has not opened a search yet, with its key.
        refused: Why the search for its last goal could not be opened, for people.
    """

    name: str
    given: GivenGoal | None = None
    refused: str = ""
