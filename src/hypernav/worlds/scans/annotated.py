"""A scan with the instances of its annotation."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Int32, Int64

from hypernav.core.labels import ObjectLabel
from hypernav.core.world import Instance
from hypernav.worlds.scans.semantic_text import Annotation
from hypernav.worlds.scenes.scene import Scene

_NO_OBJECTS = frozenset({"wall", "floor", "ceiling", "unknown", "unlabeled", "void", "misc"})


def annotated(
    scene: Scene, annotations: Sequence[Annotation], marks: Int64[np.ndarray, "faces"]
) -> Scene:
    """The scene with an instance for every annotation that has triangles.

    Instance 0 is everything without annotation. Labels are the annotators' own words.

    Args:
        scene: The scan.
        annotations: Annotations, each with a unique mark.
        marks: Mark of every triangle.
    """
    by_mark = {annotation.mark: annotation for annotation in annotations}
    present, place = np.unique(marks, return_inverse=True)
    found = [by_mark[mark] for mark in present.tolist() if mark in by_mark]
    owners = sorted(found, key=lambda annotation: annotation.id)
    number = {owner.mark: k for k, owner in enumerate(owners, start=1)}
    numbers = np.array([number.get(mark, 0) for mark in present.tolist()], dtype=np.int32)
    face_instance = numbers[place]
    instances = (_building(scene), *_instances(scene, owners, face_instance))
    return replace(scene, face_instance=face_instance, instances=instances)


def _building(scene: Scene) -> Instance:
    low, high = scene.vertices.min(axis=0), scene.vertices.max(axis=0)
    return Instance(0, "building", None, _point(low), _point(high))


def _instances(
    scene: Scene, owners: Sequence[Annotation], face_instance: Int32[np.ndarray, "faces"]
) -> list[Instance]:
    low = np.full((len(owners) + 1, 3), np.inf)
    high = np.full((len(owners) + 1, 3), -np.inf)
    corners = scene.vertices[scene.faces]
    np.minimum.at(low, face_instance, corners.min(axis=1))
    np.maximum.at(high, face_instance, corners.max(axis=1))
    return [
        Instance(number, owner.name, _label(owner), _point(low[number]), _point(high[number]))
        for number, owner in enumerate(owners, start=1)
    ]


def _label(owner: Annotation) -> ObjectLabel | None:
    return (
        None
        if owner.category.lower() in _NO_OBJECTS
        else ObjectLabel(owner.category, owner.synonyms)
    )


def _point(values: np.ndarray) -> tuple[float, float, float]:
    return (float(values[0]), float(values[1]), float(values[2]))
