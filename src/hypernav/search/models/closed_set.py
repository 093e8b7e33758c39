"""Which class of a closed set a goal names, and COCO's 80 classes."""

import difflib
from importlib.resources import files

from hypernav.core.errors import GoalError
from hypernav.core.goal import Goal
from hypernav.core.naming.labels import ObjectLabel, canonical

COCO_CLASSES: tuple[str, ...] = tuple(
    files("hypernav.search.models").joinpath("coco_classes.txt").read_text("utf-8").splitlines()
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
