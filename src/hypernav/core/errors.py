"""Every error that hypernav raises on purpose.

One class per cause. A message says what was expected, what was found and what to do.
"""


class HyPerNavError(Exception):
    """Root of the errors of this package."""


class ConfigError(HyPerNavError):
    """A configuration, option or environment variable is wrong."""


class ImportTargetError(ConfigError):
    """Something named as ``package.module:Name`` cannot be imported."""


class MissingExtraError(HyPerNavError):
    """An optional feature needs packages that are not installed."""


class CameraError(HyPerNavError):
    """Camera model and image do not belong together, or the model is impossible."""


class SceneError(HyPerNavError):
    """A scene is missing, broken or otherwise unusable."""


class NavmeshError(SceneError):
    """A scene's navigation mesh is missing, broken, or of a kind that habitat-sim doesn't write."""


class StartError(HyPerNavError):
    """A start pose is off the walkable surface, or none can be found."""


class MapError(HyPerNavError):
    """A map file is missing or broken, or no map can hold a pose or position."""


class EpisodeError(HyPerNavError):
    """An episode file or an episode in it does not hold what the format promises."""


class GoalError(HyPerNavError):
    """A goal is empty, or the chosen detector can never see it."""


class LabelsMissingError(HyPerNavError):
    """Ground-truth perception was asked of a world that supplies no labels."""


class TruthMissingError(HyPerNavError):
    """A stand-in for a model was asked in an episode without the truth that it needs."""


class ModelError(HyPerNavError):
    """A model file is missing, is not the kind of network that was expected, or does not fit."""


class ContractError(HyPerNavError):
    """A user's component, agent or world breaks its contract."""


class ComponentError(HyPerNavError):
    """A component of a user's own failed: it raised, ended the program, or returned nonsense.

    Attributes:
        details: Traceback of what it raised; empty if it only returned something impossible.
    """

    def __init__(self, message: str, details: str = "") -> None:
        """Name the component and what it did, and keep the traceback."""
        super().__init__(message)
        self.details = details


class WorldError(HyPerNavError):
    """A world was used in a wrong way, for example stepped before a reset."""


class ChatError(HyPerNavError):
    """A chat model could not be asked, or its answer cannot be used.

    Attributes:
        remedy: What to change, by what the server said; empty if it said nothing that tells.
    """

    def __init__(self, message: str, *, remedy: str = "") -> None:
        """Keep the remedy, which ends the message."""
        super().__init__(f"{message}; {remedy}" if remedy else message)
        self.remedy = remedy


class ChatTransportError(ChatError):
    """The question or the answer got lost: no connection, a broken response, a busy server."""


class ChatTimeoutError(ChatError):
    """The model took longer to answer than is allowed."""


class RefusalError(ChatError):
    """The model declined to answer."""


class UnparsableAnswerError(ChatError):
    """The answer is not of the kind that was asked for."""


class InvalidAnswerError(ChatError):
    """The answer is of the kind that was asked for, but none of the possible ones."""


class ModelUnavailableError(ChatError):
    """A chat model did not answer within the configured patience.

    An episode that ends with it says nothing about navigation and is never counted as a failure.
    """


class ModelRejectedError(ModelUnavailableError):
    """A server will never answer this question."""


class ModelSetupError(ChatError):
    """URL, key or choice of the model are wrong: no question succeeds until they are corrected."""


class OutputError(HyPerNavError):
    """A result cannot be written: an impossible name, no permission, a full disk."""


class ViewError(HyPerNavError):
    """A search cannot be shown live: its viewer does not start, or no address is free."""


class CrashError(HyPerNavError):
    """The program itself failed in another process.

    Attributes:
        details: Traceback of the failure.
    """

    def __init__(self, message: str, details: str) -> None:
        """Name what failed, and keep the traceback."""
        super().__init__(message)
        self.details = details


class RunFolderError(HyPerNavError):
    """The folder of a run is in use, damaged, not writable, or belongs to another run.

    An evaluation has such a folder, and so has the server of robots.
    """


class MemoryFolderError(HyPerNavError):
    """A memory on disk is damaged, of another version, or of another robot or building."""


class MemoryStartError(HyPerNavError):
    """What a robot sees at its start contradicts the map that it remembers."""


class RecordingError(HyPerNavError):
    """A recording, of a chat model or of a camera, is broken or lacks what is requested."""


class WireError(HyPerNavError):
    """A message between a robot and its server does not follow the contract."""


class RosMessageError(HyPerNavError):
    """A ROS message is broken, or of a kind that can't be used."""


class TransformMissingError(HyPerNavError):
    """The frames of a ROS robot are not connected at the time that is asked for."""


class RosNetworkError(HyPerNavError):
    """A ROS 2 network can't be joined, a robot's data doesn't arrive, or it doesn't stand still."""


class Nav2Error(HyPerNavError):
    """Nav2 does not drive the robot: it takes no goals, or makes no progress to any."""


class TopicChoiceError(HyPerNavError):
    """No ROS topic, or more than one, could be the one that is needed."""


class RequestRefusedError(HyPerNavError):
    """A robot's server refuses a request.

    Attributes:
        error: Kind of the refusal, one word (`hypernav.robot.wire.replies.ErrorBody`).
        status: HTTP status that goes with it.
        expected: Sequence number that is expected, where a number was refused.
    """

    def __init__(
        self, message: str, *, error: str, status: int, expected: int | None = None
    ) -> None:
        """Say what is refused and why."""
        super().__init__(message)
        self.error = error
        self.status = status
        self.expected = expected


class RobotLinkError(HyPerNavError):
    """A robot can't work with its server: the address is wrong, or the token can't be read."""


class LinkLostError(RobotLinkError):
    """A request of a robot, or the answer to it, got lost."""


class SensorError(HyPerNavError):
    """What a robot senses can't be right: a frozen camera, odometry with wrong signs or units."""


class ServerUnreachableError(RobotLinkError):
    """A robot's server gave no answer for longer than the patience; the robot stands still."""
