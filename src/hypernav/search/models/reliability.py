"""How far the scores of a network can be trusted: measured, and kept with the network's file.

`hypernav exam --detector yolox:FILE --calibrate` measures it and writes the file beside the
network. Of a few well-known files it is known already (``reliability.toml``).
"""

import hashlib
import tomllib
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from hypernav.core.config import Curve
from hypernav.core.errors import ModelError, OutputError
from hypernav.core.score_weights import MISSED
from hypernav.io.reading import read_file
from hypernav.io.writing import write_whole


class Reliability(BaseModel):
    """What the answers of one network are worth as evidence, by its views of training buildings.

    Attributes:
        format: What the file is.
        sha256: Hash of the network's file.
        boxes: Scores, and how much an image with such a box shifts the log-odds that this is the
            goal (`hypernav.core.score_weights`).
        missed: The same for an image that should show a candidate, but gave no box of it.
        buildings: Buildings that were looked at; empty if it was not measured here.
        images: Number of images.
        right: Number of things that were taken for what they are.
        alike: Number of things that were taken for something else.
        nothing: Number of boxes around no thing, such as walls; they are not in the weights.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    format: Literal["hypernav-reliability"] = "hypernav-reliability"
    sha256: str
    boxes: Curve = Field(min_length=1)
    missed: float = Field(default=MISSED, ge=-10.0, le=0.0)
    buildings: tuple[str, ...] = ()
    images: int = Field(default=0, ge=0, le=10**9)
    right: int = Field(default=0, ge=0, le=10**9)
    alike: int = Field(default=0, ge=0, le=10**9)
    nothing: int = Field(default=0, ge=0, le=10**9)


@cache
def known() -> dict[str, Reliability]:
    """Well-known networks by name."""
    text = files("hypernav.search.models").joinpath("reliability.toml").read_text("utf-8")
    return {name: Reliability.model_validate(one) for name, one in tomllib.loads(text).items()}


def file_beside(network: Path) -> Path:
    """Where the reliability of a network is kept."""
    return network.with_name(f"{network.name}.reliability.json")


def sha256_of(network: Path) -> str:
    """Hash of a network's file.

    Raises:
        ModelError: It can't be read.
    """
    try:
        return hashlib.sha256(read_file(network)).hexdigest()
    except OSError as error:
        raise ModelError(f"{network} cannot be read ({error.strerror or error})") from error


def reliability_of(network: Path) -> Reliability | None:
    """What is known of a network: its own file first; None if nothing is.

    Raises:
        ModelError: The file beside it is damaged, or of another network.
    """
    sha256, beside = sha256_of(network), file_beside(network)
    if not beside.exists():
        return next((one for one in known().values() if one.sha256 == sha256), None)
    again = "measure it again with hypernav exam --calibrate, or remove the file"
    try:
        found = Reliability.model_validate_json(read_file(beside))
    except (OSError, ValidationError) as error:
        said = error.errors()[0]["msg"] if isinstance(error, ValidationError) else error.strerror
        raise ModelError(f"{beside} cannot be used ({said}); {again}") from error
    if found.sha256 != sha256:
        raise ModelError(f"{beside} was measured of another {network.name}; {again}")
    return found


def write_reliability(network: Path, measured: Reliability) -> Path:
    """Keep what was measured of a network beside it.

    Raises:
        OutputError: The file can't be written.
    """
    path = file_beside(network)
    try:
        write_whole(path, measured.model_dump_json(indent=2) + "\n")
    except OSError as error:
        raise OutputError(f"{path} cannot be written ({error.strerror or error})") from error
    return path
