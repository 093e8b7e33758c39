"""Steps a second of the Gymnasium environment, in one process.

The clock's figure depends on what else the machine does; that of the processor's time doesn't, and
is what one core would reach.

Run: python benchmarks/gym_steps.py [--scene houses:7] [--width 160] [--height 120] [--colours]
"""

import argparse
import time

import gymnasium
import numpy as np

import hypernav.envs


def main() -> None:
    parser = argparse.ArgumentParser(description="Steps a second of the Gymnasium environment.")
    parser.add_argument("--scene", default="houses:7")
    parser.add_argument("--width", type=int, default=160)
    parser.add_argument("--height", type=int, default=120)
    parser.add_argument("--colours", action="store_true", help="draw images in colours, too")
    parser.add_argument("--steps", type=int, default=500)
    options = parser.parse_args()
    gymnasium.register_envs(hypernav.envs)
    env = gymnasium.make(
        "hypernav/ObjectNav-v0",
        scene=options.scene,
        size=(options.width, options.height),
        colours=options.colours,
    )
    drive(env, 50)  # compiles kernels, fills caches
    clock, processor = time.perf_counter(), time.process_time()
    drive(env, options.steps)
    clock, processor = time.perf_counter() - clock, time.process_time() - processor
    print(f"by the clock: {options.steps / clock:.0f} steps a second")
    print(f"by the processor's time: {options.steps / processor:.0f} steps a second and core")


def drive(env: gymnasium.Env, steps: int) -> None:
    """Take random actions other than STOP."""
    rng = np.random.default_rng(0)
    env.reset(seed=0)
    for action in rng.choice([1, 1, 2, 3], size=steps).tolist():
        _, _, terminated, truncated, _ = env.step(action)
        if terminated or truncated:
            env.reset()


if __name__ == "__main__":
    main()
