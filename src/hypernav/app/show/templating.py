"""Jinja environment, style sheet and data URIs that all pages share."""

import base64
import io
import json
from collections.abc import Mapping, Sequence
from html import escape
from importlib.metadata import version
from typing import Any

import numpy as np
from jaxtyping import UInt8
from jinja2 import ChoiceLoader, Environment, PackageLoader, StrictUndefined
from PIL import Image

from hypernav.app.show import captions
from hypernav.core.naming.words import visible
from hypernav.core.trace import Mode
from hypernav.search.drawing import palette


def page_environment(*packages: str) -> Environment:
    """Templates that share one style sheet, ``base.html.j2``, with autoescape on.

    Args:
        packages: Further packages whose ``templates`` folder is searched first, for example
            ``"hypernav.lab.evaluation"``.
    """
    loaders = [PackageLoader(package, "templates") for package in (*packages, "hypernav.app.show")]
    environment = Environment(
        loader=ChoiceLoader(loaders),
        autoescape=True,
        undefined=StrictUndefined,
        finalize=_shown,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.policies["json.dumps_function"] = _shown_json
    environment.filters["css"] = palette.css
    environment.filters["sentence"] = captions.sentence
    environment.filters["duration"] = captions.duration
    environment.globals["number"] = captions.number
    environment.globals["colors"] = page_colors()
    environment.globals["version"] = version("hypernav")
    return environment


def _shown(value: Any) -> Any:
    """A value of a template whose control characters are made visible."""
    match value:
        case str():
            shown = visible(value)
            return value if shown == value else type(value)(shown)  # markup stays markup
        case dict():
            return {key: _shown(one) for key, one in value.items()}
        case list() | tuple():
            return [_shown(one) for one in value]
    return value


def _shown_json(value: Any, **options: Any) -> str:
    return json.dumps(_shown(value), **options)


def page_colors() -> dict[str, dict[str, str]]:
    """CSS colours by name, under ``light`` and ``dark``."""
    named = {
        "good": palette.SUCCESS,
        "bad": palette.FAILURE,
        "robot": palette.ROBOT,
        "path": palette.PATH,
        "chosen": palette.CHOSEN,
        "way": palette.TRAJECTORY_NEW,
        **{mode_name(mode): color for mode, color in palette.MODES.items()},
        **{f"series-{n}": color for n, color in enumerate(palette.SERIES, 1)},
    }
    return {
        "light": {name: palette.css(color) for name, color in named.items()},
        "dark": {
            name: palette.css(palette.blend(color, palette.PAPER, 0.3))
            for name, color in named.items()
        },
    }


def mode_name(mode: Mode) -> str:
    """The CSS class of a mode, for example ``mode-look-around``."""
    return f"mode-{mode.value.replace(' ', '-')}"


def data_uri(content: bytes, kind: str) -> str:
    """A file as a data URI.

    Args:
        content: Bytes of the file.
        kind: MIME type, for example ``image/png``.
    """
    return f"data:{kind};base64,{base64.b64encode(content).decode('ascii')}"


def image_uri(image: UInt8[np.ndarray, "_ _ 3"]) -> str:
    """An image as a data URI, quantized to 128 colours.

    Args:
        image: RGB.
    """
    buffer = io.BytesIO()
    colors = Image.fromarray(image).quantize(128, dither=Image.Dither.NONE)
    colors.save(buffer, format="PNG", optimize=True)
    return data_uri(buffer.getvalue(), "image/png")


def html_table(rows: Sequence[Mapping[str, Any]]) -> str:
    """A table for notebooks, one row for each mapping; all have the keys of the first."""
    columns = list(rows[0]) if rows else []
    head = "".join(f"<th>{escape(visible(name))}</th>" for name in columns)
    body = "".join(
        f"<tr>{''.join(f'<td>{_cell(row[name])}</td>' for name in columns)}</tr>" for row in rows
    )
    return f"<table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _cell(value: Any) -> str:
    return escape(visible(value if isinstance(value, str) else captions.number(value)))


def plain(value: Any) -> Any:
    """Any configuration or result as plain JSON data."""
    return json.loads(json.dumps(value, default=str))
