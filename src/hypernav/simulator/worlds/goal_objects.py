"""Finds the objects that an episode's file names as its goals among a scene's instances."""

import re
from collections.abc import Sequence
from dataclasses import replace

from hypernav.core.episode import Episode
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.world import Instance


def named_as_goals(instances: Sequence[Instance], episode: Episode) -> tuple[Instance, ...]:
    """The instances; those that the episode names as goals get its goal as a further name.

    A data set's categories are not always the annotators' words: HM3D's "tv" may be a "flat screen"
    in the scene. An object is found by its name in the scene, ``chair_123``, or, if the scene does
    not have that name, by the number at its end, which is that of the annotation.

    Args:
        instances: All instances of the scene; an instance's id is its index.
        episode: The episode.
    """
    if not episode.objects:
        return tuple(instances)
    by_name: dict[str | None, int] = {instance.name: instance.id for instance in instances}
    by_number: dict[int | None, int] = {
        int(found[1]): instance.id
        for instance in instances
        if (found := re.search(r"_(\d+)$", instance.name, re.ASCII)) is not None
    }
    called = list(instances)
    for wanted in episode.objects:
        number = by_name.get(wanted.name, by_number.get(wanted.number))
        if number is not None:
            called[number] = _called(called[number], episode)
    return tuple(called)


def _called(instance: Instance, episode: Episode) -> Instance:
    label = instance.label or ObjectLabel(episode.goal.text)
    if label.satisfies(episode.goal):
        return instance if instance.label is label else replace(instance, label=label)
    label = replace(label, synonyms=(*label.synonyms, episode.goal.text))
    return replace(instance, label=label)
