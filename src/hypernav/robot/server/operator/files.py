"""The files of the operator's page: no build step, and nothing loaded from other sites."""

import json
from pathlib import Path

from starlette.responses import Response

from hypernav.core.actions import Action
from hypernav.show.captions import MODES, QUESTIONS
from hypernav.show.drawing import palette
from hypernav.show.templating import page_environment

_FOLDER = Path(__file__).parent / "page"
_KINDS = {".html": "text/html", ".css": "text/css", ".js": "text/javascript"}
_HEADERS = {
    "cache-control": "no-cache",
    "content-security-policy": (
        "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data:; "
        "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    ),
    "referrer-policy": "no-referrer",
    "x-content-type-options": "nosniff",
}
_ACTIONS = {
    Action.STOP: "stop",
    Action.MOVE_FORWARD: "forward",
    Action.TURN_LEFT: "turn left",
    Action.TURN_RIGHT: "turn right",
}


def page_files() -> dict[str, Response]:
    """Responses by file name; ``index.html`` is the page.

    Besides the files of the package there are ``style.css``, shared by all pages, and
    ``vocabulary.js``, the colours and words that page, video and map share.
    """
    texts = {path.name: path.read_text(encoding="utf-8") for path in _FOLDER.iterdir()}
    texts["style.css"] = page_environment().get_template("style.css.j2").render()
    texts["vocabulary.js"] = _vocabulary()
    return {
        name: Response(text, media_type=_KINDS[Path(name).suffix], headers=_HEADERS)
        for name, text in texts.items()
    }


def _vocabulary() -> str:
    """A JavaScript module of constants."""
    colors = {
        name.lower(): palette.css(color)
        for name, color in vars(palette).items()
        if name.isupper() and isinstance(color, tuple) and isinstance(color[0], int)
    }
    constants = {
        "COLORS": colors,
        "MODE_COLORS": {mode.value: palette.css(color) for mode, color in palette.MODES.items()},
        "MODES": {mode.value: words for mode, words in MODES.items()},
        "QUESTIONS": QUESTIONS,
        "ACTIONS": {int(action): words for action, words in _ACTIONS.items()},
    }
    return "".join(
        f"export const {name} = {json.dumps(value)};\n" for name, value in constants.items()
    )
