"""Plug in a detector of your own: anything with a `detect` method.

This one finds red things by their colour; the only one in the built-in house is the fruit in a
bowl. The rest of the agent turns the pixels into a position on the map.

Run: python examples/02_your_own_detector.py

Saved as red_things.py, the same class serves on the command line, in the same folder:
hypernav find "fruit bowl" --detector red_things:RedThings
"""

import cv2
import numpy as np

import hypernav
from hypernav import Box, Detection, Goal, Observation


class RedThings:
    """Detects everything that is strongly red, whatever the goal."""

    def detect(self, observation: Observation, goal: Goal) -> list[Detection]:
        hue, saturation, value = cv2.split(cv2.cvtColor(observation.rgb, cv2.COLOR_RGB2HSV))
        red = ((hue < 8) | (hue > 172)) & (saturation > 140) & (value > 60)
        _, numbers, stats, _ = cv2.connectedComponentsWithStats(red.astype(np.uint8))
        detections = []
        for number, (left, top, width, height, area) in enumerate(stats.tolist()):
            if number > 0 and area > 200:
                box = Box(left, top, left + width, top + height)
                score = area / (width * height)
                detections.append(Detection(box, score, goal.text, mask=numbers == number))
        return sorted(detections, key=lambda detection: -detection.box.area)


def main() -> None:
    agent = hypernav.build_search(hypernav.preset("default"), RedThings())
    search = hypernav.find("fruit bowl", "builtin", agent=agent, seed=3, max_steps=120)
    for step in search:
        for detection in step.trace.detections:
            print(f"{step.trace.step:3d}  {detection.label} at {detection.box}")
    print(search.result().outcome)


if __name__ == "__main__":
    main()
