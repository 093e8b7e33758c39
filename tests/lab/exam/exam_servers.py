"""Brains for the scripted server that know every answer of an exam, and spoil them on purpose."""

import json
import random
import threading
from collections.abc import Sequence
from typing import Literal

import cv2
import numpy as np

from hypernav.core.exploring.guidance import GuideView
from hypernav.core.exploring.overview import Overview
from hypernav.core.geometry.boxes import Box
from hypernav.core.observation import Observation
from hypernav.lab.exam.questions import ExamQuestion
from hypernav.search.models.chat.vlm_families import family_named
from hypernav.search.perception.image_recall import sheet_of
from servers.scripted import Asked

Spoiled = Literal[
    "", "swapped axes", "0 to 1000", "always yes", "always block 1", "ignores absence", "half"
]
_KINDS = {
    "ground": "boxes",
    "choose block": "block",
    "verify": "presence",
    "choose arrow": "arrow",
    "choose direction": "direction",
    "score view": "near",
    "choose images": "images",
}


class Knower:
    """Knows the right answers, as it recognises the images, and makes one mistake all the time."""

    def __init__(self, questions: Sequence[ExamQuestion], spoiled: Spoiled = "") -> None:
        self.spoiled: Spoiled = spoiled
        self._known = [(_thumbnail(_image(one)), one) for one in questions]
        self._rng, self._lock = random.Random(0), threading.Lock()

    def __call__(self, asked: Asked) -> str:
        with self._lock:
            babbles = self.spoiled == "half" and self._rng.random() < 0.7
        if babbles:
            return "I like turtles."
        kind = _KINDS.get(asked.kind)
        if kind is None:
            return "yes"
        question = self._question(kind, asked)
        if kind == "boxes":
            return json.dumps(self._boxes(question))
        right = min(question.right, key=lambda one: (len(one), one))
        if kind == "images":
            blind = "ignores absence" if right == "none" else "always block 1"
            return "1" if self.spoiled == blind else ", ".join(sorted(question.right))
        match kind:
            case "block":
                return f"It leads on.\nAnswer: {self._block(question, right)}"
            case "arrow":
                return json.dumps({"action": int(right)})
            case "direction":
                return right
        return "yes" if self.spoiled == "always yes" else right

    def _question(self, kind: str, asked: Asked) -> ExamQuestion:
        seen = _thumbnail(asked.images[0])
        of_kind = [
            (float(np.abs(small - seen).mean()), one)
            for small, one in self._known
            if one.kind == kind and one.goal.thing in asked.text
        ]
        return min(of_kind, key=lambda pair: pair[0])[1]

    def _block(self, question: ExamQuestion, right: str) -> str:
        return "1" if self.spoiled == "always block 1" else right

    def _boxes(self, question: ExamQuestion) -> list[dict[str, object]]:
        observation = question.subject
        assert isinstance(observation, Observation)
        height, width = observation.rgb.shape[:2]
        name = "thousandths" if self.spoiled == "0 to 1000" else "qwen2.5-vl"
        boxes = question.boxes
        if not boxes and self.spoiled == "ignores absence":
            boxes = (Box(0.2 * width, 0.3 * height, 0.6 * width, 0.8 * height),)
        said = []
        for box in boxes[:1]:
            own = family_named(name).from_image(box, width, height)
            edges = [own.x_min, own.y_min, own.x_max, own.y_max]
            if self.spoiled == "swapped axes":
                edges = [edges[1], edges[0], edges[3], edges[2]]
            said.append({"bbox_2d": [round(float(e)) for e in edges], "label": question.goal.text})
        return said


def _image(question: ExamQuestion) -> np.ndarray:
    match question.subject:
        case Overview():
            return question.subject.draw([int(option) for option in question.costs], ())
        case GuideView():
            return question.subject.images[0]
        case Observation():
            return question.subject.rgb
        case tuple():
            return sheet_of([one.rgb for one in question.subject])
        case view:
            return view.image


def _thumbnail(image: np.ndarray) -> np.ndarray:
    return cv2.resize(image, (24, 24), interpolation=cv2.INTER_AREA).astype(float)
