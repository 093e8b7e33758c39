"""The page of the study of goal refinement, and its files."""

import csv
from collections.abc import Sequence
from dataclasses import asdict, fields
from pathlib import Path

from PIL import Image

from hypernav.core.errors import OutputError
from hypernav.evaluation.refinement.area_record import AreaRecord
from hypernav.evaluation.refinement.boxes import JITTER_SHARE, MATCHING_IOU
from hypernav.evaluation.refinement.example_image import Rgb
from hypernav.evaluation.refinement.summary import Measure, Row, table
from hypernav.evaluation.report.report_text import number_of
from hypernav.show.pages.templating import image_uri, page_environment

PAGE = "index.html"
CSV = "refinement.csv"
EXAMPLE = "example.png"


def write_refinement(
    folder: Path, records: Sequence[AreaRecord], example: Rgb | None, *, lead: str
) -> Path:
    """Write the page, ``refinement.csv`` and ``example.png``.

    Args:
        folder: Folder of the study.
        records: Records of all episodes.
        example: Image of a frame and its goal areas; None leaves it out.
        lead: Sentence that says what was studied.

    Returns:
        Path of the page, which is one file and needs no network.

    Raises:
        OutputError: The folder can't be written.
    """
    page = page_environment("hypernav.evaluation").get_template("refinement.html.j2")
    text = page.render(
        rows=table(records),
        lead=lead,
        is_typical=len({(record.scene_id, record.episode_id) for record in records}) > 1,
        example="" if example is None else image_uri(example),
        jitter=JITTER_SHARE,
        iou=MATCHING_IOU,
    )
    try:
        (folder / PAGE).write_text(text, encoding="utf-8")
        _write_csv(folder / CSV, records)
        if example is not None:
            Image.fromarray(example).save(folder / EXAMPLE)
    except OSError as error:
        raise OutputError(f"{folder} cannot be written ({error.strerror or error})") from error
    return folder / PAGE


def result_lines(records: Sequence[AreaRecord]) -> list[str]:
    """The table in lines of text, for the terminal, or a line that says that it is empty."""
    lines = [_line(row) for row in table(records)]
    return lines or ["nothing was measured: no episode showed its goal within the range of depth"]


def _line(row: Row) -> str:
    return (
        f"{row.box.value} box, {row.mask.value}: off target {_said(row.off_target)}, unreachable "
        f"or occluded {_said(row.useless)}, no success {_said(row.no_success)} "
        f"({number_of(row.episodes, 'episode')})"
    )


def _said(measure: Measure) -> str:
    drop = "" if measure.drop is None else f" (drop {100 * measure.drop.mean:.0f} %)"
    return f"{100 * measure.share.mean:.1f} %{drop}"


def _write_csv(path: Path, records: Sequence[AreaRecord]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, [field.name for field in fields(AreaRecord)])
        writer.writeheader()
        writer.writerows(asdict(record) for record in records)
