"""Every error that hypernav raises on purpose.

One class per cause. A message says what was expected, what was found and what to do.
"""


class HyPerNavError(Exception):
    """Root of all errors of this package."""


class ConfigError(HyPerNavError):
    """A configuration file, option or environment variable is wrong."""


class MissingExtraError(HyPerNavError):
    """An optional feature needs packages that are not installed."""


class CameraError(HyPerNavError):
    """Camera model and image do not belong together, or the model is impossible."""


class SceneError(HyPerNavError):
    """A scene file is missing, broken, empty or not a mesh."""


class StartError(HyPerNavError):
    """A start pose is off the walkable surface, or none can be found."""


class MapError(HyPerNavError):
    """A map file is missing or broken, or a pose or place is one that no map can hold."""


class EpisodeError(HyPerNavError):
    """An episode file or an episode in it does not hold what the format promises."""


class GoalError(HyPerNavError):
    """A goal is empty, or the chosen detector can never see it."""


class LabelsMissingError(HyPerNavError):
    """Ground-truth perception was asked of a world that supplies no labels."""


class ModelError(HyPerNavError):
    """A model file is missing or is not the kind of network that was expected."""


class WorldError(HyPerNavError):
    """A world was used against its contract, for example stepped before a reset."""
