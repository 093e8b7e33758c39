"""What may happen in a step of a search; the trace holds the words."""

from enum import StrEnum


class Event(StrEnum):
    """Kinds of events, each with its words in the trace."""

    GOAL_SEEN = "goal seen"
    GOAL_SEEN_FAR_AWAY = "goal seen far away"
    GOAL_SEEN_ON_OTHER_FLOOR = "goal seen on another floor"
    GOAL_ON_THIS_FLOOR = "goal is on this floor after all"
    GOAL_OUT_OF_REACH = "goal out of reach for now"
    GOAL_REACHED = "goal reached"
    SAID_TO_BE_AT_GOAL = "said to be at the goal"

    AREA_GIVEN_UP = "goal area given up for now"
    AREA_NOT_IN_SIGHT = "goal area not in sight from here"
    AREA_REJECTED = "goal area rejected"
    AREA_RECONSIDERED = "rejected goal area reconsidered"
    SECOND_LOOK_WANTED = "second look wanted"
    GAP_CLOSED = "gap closed"

    DESTINATION_REACHED = "destination reached"
    DESTINATION_EXPLORED = "destination explored"
    DESTINATION_CHANGED = "destination changed"
    NO_PATH = "no path to destination"
    NO_PROGRESS = "no progress to destination"
    ENDURANCE_EXCEEDED = "endurance exceeded"
    NOWHERE_TO_GO = "nowhere to go on to"
    LOOKING_AGAIN = "all is known, looking again"

    THING_GONE = "remembered thing is gone"
    THING_IS_ANOTHER = "remembered thing is another"
    THING_NOT_IN_SIGHT = "remembered thing not in sight from here"

    ONTO_STAIRS = "came onto stairs sooner than planned"
    TURNING_BACK = "turning back on the stairs"
    STAIRS_GIVEN_UP = "stairs given up"
    LEVEL_REACHED = "another level reached"
    FLOOR_REACHED = "another floor reached"
    FLOOR_OF_GOAL_REACHED = "floor of the goal reached"
