"""Small images of the questions, with true and answered boxes drawn in."""

import io
from pathlib import Path

import cv2
import numpy as np
from jaxtyping import UInt8
from PIL import Image

from hypernav.core.exploring.guidance import GuideView
from hypernav.core.exploring.overview import Overview
from hypernav.core.observation import Observation
from hypernav.io.foreign_folder import ForeignFolder
from hypernav.lab.exam.questions import Answered, ExamQuestion
from hypernav.search.drawing import palette
from hypernav.search.perception.image_recall import sheet_of

_WIDTH = 420
PICTURES = "pictures"


def picture_of(folder: Path, question_id: str) -> Path:
    """Path of the image of a question, in the folder of the exam."""
    return folder / PICTURES / (question_id.replace("/", "_").replace(":", "-") + ".webp")


def write_picture(folder: Path, question: ExamQuestion, answered: Answered) -> None:
    """Draw a question and its boxes, true and answered, and write the image as WebP."""
    data = io.BytesIO()
    Image.fromarray(_drawn(question, answered)).save(data, "WEBP", quality=70)
    with ForeignFolder(folder) as home:
        home.make_folder(PICTURES)
        home.write(
            f"{PICTURES}/{picture_of(folder, question.id).name}", data.getvalue(), sync=False
        )


def _drawn(question: ExamQuestion, answered: Answered) -> UInt8[np.ndarray, "_ _ 3"]:
    match question.subject:
        case Overview():
            shown = {int(option) for option in question.costs}
            image = question.subject.draw(shown, ())
        case GuideView() | Observation():
            frame = question.subject
            image = (frame if isinstance(frame, Observation) else frame.observation).rgb
        case tuple():
            image = sheet_of([frame.rgb for frame in question.subject])
        case view:
            image = view.image
    image = np.ascontiguousarray(image).copy()
    thick = max(image.shape[1] // 200, 2)
    for boxes, color in ((answered.true_boxes, palette.SUCCESS), (answered.boxes, palette.CHOSEN)):
        for x_min, y_min, x_max, y_max in boxes:
            corners = (round(x_min), round(y_min)), (round(x_max), round(y_max))
            cv2.rectangle(image, *corners, color, thick)
    height = round(image.shape[0] * _WIDTH / image.shape[1])
    return cv2.resize(image, (_WIDTH, height), interpolation=cv2.INTER_AREA).astype(np.uint8)
