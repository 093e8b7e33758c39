"""What scores of detections are worth where nothing, or little, was measured.

A weight is the shift of the log-odds that a thing is the goal by one image: the logarithm of how
often a detector says so of the goal, divided by how often of what it mistakes for it, less what
images of one thing have in common.
"""

from hypernav.core.config import Curve

NEUTRAL: Curve = ((0.0, -0.4), (0.3, 0.1), (0.6, 0.9), (0.95, 1.35), (1.0, 5.0))
"""Of a detector that was never measured: a higher score is better, but half as much as with
YOLOX-nano, so that twice as many images are needed. A score of 1 is that of one without scores.
The values are ours; what they cost or save in searches is not measured."""
MISSED = -0.8
"""Of an image that should show a candidate, but gave no sighting of it."""
