"""The 80 classes of COCO, and which of them a goal names."""

import difflib

from hypernav.core.errors import GoalError
from hypernav.core.goal import Goal
from hypernav.core.labels import ObjectLabel, canonical

COCO_CLASSES: tuple[str, ...] = tuple(
    [
        "person",
        "bicycle",
        "car",
        "motorcycle",
        "airplane",
        "bus",
        "train",
        "truck",
        "boat",
        "traffic light",
        "fire hydrant",
        "stop sign",
        "parking meter",
        "bench",
        "bird",
        "cat",
        "dog",
        "horse",
        "sheep",
        "cow",
        "elephant",
        "bear",
        "zebra",
        "giraffe",
        "backpack",
        "umbrella",
        "handbag",
        "tie",
        "suitcase",
        "frisbee",
        "skis",
        "snowboard",
        "sports ball",
        "kite",
        "baseball bat",
        "baseball glove",
        "skateboard",
        "surfboard",
        "tennis racket",
        "bottle",
        "wine glass",
        "cup",
        "fork",
        "knife",
        "spoon",
        "bowl",
        "banana",
        "apple",
        "sandwich",
        "orange",
        "broccoli",
        "carrot",
        "hot dog",
        "pizza",
        "donut",
        "cake",
        "chair",
        "couch",
        "potted plant",
        "bed",
        "dining table",
        "toilet",
        "tv",
        "laptop",
        "mouse",
        "remote",
        "keyboard",
        "cell phone",
        "microwave",
        "oven",
        "toaster",
        "sink",
        "refrigerator",
        "book",
        "clock",
        "vase",
        "scissors",
        "teddy bear",
        "hair drier",
        "toothbrush",
    ]
)


def class_for(goal: Goal, classes: tuple[str, ...]) -> int:
    """The class of a closed set that a goal names.

    Synonyms are accepted ("sofa" is COCO's "couch"), and so is a bare head noun ("table" is
    "dining table"). Attributes and places are not: a closed-set detector that is asked for a
    "red chair" would stop at any chair.

    Raises:
        GoalError: The goal is none of the classes; the message names the closest ones.
    """
    wanted = canonical(goal.text)
    for number, name in enumerate(classes):
        if canonical(name) == wanted:
            return number
    for number, name in enumerate(classes):
        if ObjectLabel(name).is_named(goal.text):
            return number
    raise GoalError(
        f"this detector knows {len(classes)} kinds of things and '{goal.text}' is none of them; "
        f"closest: {', '.join(_closest(wanted, classes))}"
    )


def _closest(wanted: str, classes: tuple[str, ...]) -> list[str]:
    """Up to three class names: those that the goal contains, then those with a similar spelling."""
    by_name = {canonical(name): name for name in classes}
    contained = [name for key, name in by_name.items() if f" {key} " in f" {wanted} "]
    alike = [by_name[key] for key in difflib.get_close_matches(wanted, list(by_name), 3, 0.4)]
    found = list(dict.fromkeys(contained + alike))[:3]
    return found or sorted(classes)[:3]
