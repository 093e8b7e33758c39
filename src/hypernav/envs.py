"""The environments of this package; importing this module registers them with Gymnasium.

Examples:
    >>> import gymnasium, hypernav.envs  # doctest: +SKIP
    >>> gymnasium.make("hypernav/ObjectNav-v0", scene="houses:7", size=(160, 120))  # doctest: +SKIP

``gymnasium.make("hypernav.envs:hypernav/ObjectNav-v0")`` imports it by itself, in every process.
"""

import gymnasium

gymnasium.register("hypernav/ObjectNav-v0", entry_point="hypernav.app.build.env:ObjectNavEnv")
gymnasium.register(
    "hypernav/HabitatObjectNav-v0",
    entry_point="hypernav.lab.evaluation.habitat_lab.gym_env:HabitatGymEnv",
)
