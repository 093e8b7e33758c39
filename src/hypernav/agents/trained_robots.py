"""Robots that published policies were trained on."""

from collections.abc import Mapping

from hypernav.core.embodiment import CameraConfig, Embodiment
from hypernav.core.errors import ConfigError

Camera = Mapping[str, float]
"""Values of a `CameraConfig` that a policy depends on."""
HM3D_CAMERA: Camera = {
    "width": 640,
    "height": 480,
    "hfov_deg": 79.0,
    "height_m": 0.88,
    "pitch_deg": 0.0,
}
SQUARE_CAMERA: Camera = {
    "width": 128,
    "height": 128,
    "hfov_deg": 90.0,
    "height_m": 1.25,
    "pitch_deg": 0.0,
}
_MOTION = {"forward_m": 0.25, "turn_angle_deg": 30.0}


def check_robot(name: str, embodiment: Embodiment, cameras: tuple[Camera, ...]) -> None:
    """Refuse a robot that a policy was not trained on, and say what differs.

    Raises:
        ConfigError: Camera, step or turn are others.
    """
    motion = embodiment.motion.model_dump()
    wrong = [
        f"embodiment.motion.{key} is {motion[key]:g} instead of {value:g}"
        for key, value in _MOTION.items()
        if motion[key] != value
    ]
    wrong += min((_differences(embodiment.camera, camera) for camera in cameras), key=len)
    if wrong:
        raise ConfigError(
            f"{name} was trained on one robot, and any other breaks it: {', '.join(wrong)}; set "
            "them so with --set"
        )


def _differences(camera: CameraConfig, trained: Camera) -> list[str]:
    values = camera.model_dump()
    return [
        f"embodiment.camera.{key} is {values[key]:g} instead of {value:g}"
        for key, value in trained.items()
        if values[key] != value
    ]
