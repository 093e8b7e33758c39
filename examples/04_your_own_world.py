"""Check a world of your own: any Gymnasium environment with the observations of ObjectNav.

`hypernav.check_world` moves the robot in the world and says what breaks the contract. The world
here is the built-in one with a mistake in it: yaw is counted clockwise.

Run: python examples/04_your_own_world.py
"""

from typing import Any

import numpy as np

import hypernav
from hypernav import ContractError, ObjectNavEnv


class Clockwise(ObjectNavEnv):
    """Reports poses in a mirrored frame, as some game engines do."""

    def reset(self, **options: Any) -> tuple[dict[str, Any], dict[str, Any]]:
        seen, info = super().reset(**options)
        return self._mirrored(seen), info

    def step(self, action: Any) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        seen, reward, terminated, truncated, info = super().step(action)
        return self._mirrored(seen), reward, terminated, truncated, info

    @staticmethod
    def _mirrored(seen: dict[str, Any]) -> dict[str, Any]:
        return seen | {"pose": seen["pose"] * np.array([1.0, -1.0, -1.0])}


def main() -> None:
    scene = hypernav.load_scene("builtin")
    hypernav.check_world(ObjectNavEnv(scene))
    print("the built-in world keeps its contract")
    try:
        hypernav.check_world(Clockwise(scene))
    except ContractError as error:
        print(error)


if __name__ == "__main__":
    main()
