"""Search for a bed in the built-in house and print the reason of every action.

Run: python examples/01_find_in_simulation.py [GOAL]
"""

import sys

import hypernav


def main() -> None:
    search = hypernav.find(sys.argv[1] if len(sys.argv) > 1 else "bed", "builtin")
    for step in search:
        print(f"{step.trace.step:3d}  {step.trace.mode:12s} {step.trace.reason}")

    result = search.result()
    print(f"{result.outcome}: SPL {result.metrics.spl:.2f} in {result.steps} steps")


if __name__ == "__main__":
    main()
