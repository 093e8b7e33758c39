"""What results depend on as on code: files given to components, and words of questions."""

import hashlib
import os
from collections.abc import Iterable
from pathlib import Path

from hypernav.app.build.components.choosing import ChosenComponents
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.errors import ModelError
from hypernav.search.models.reliability import file_beside
from hypernav.search.perception.config import CROP_WORDS
from hypernav.search.perception.exchanges import prompt_hash
from hypernav.search.rivals.config import DIRECTION, DIRECTION_PAST, ONE_ARROW, SEVERAL_ARROWS

_DIGITS = 16


def given_files(chosen: ChosenComponents, config: HyPerNavConfig) -> tuple[Path, ...]:
    """The files given to components by specifications or by the configuration.

    Args:
        chosen: Components in use.
        config: Configuration of everything.
    """
    written = [text for choice in chosen.by_kind.values() for text in choice.arguments]
    written += [str(file_beside(Path(text))) for text in written]
    if chosen.agent.entry.section == "policy":
        written.append(config.policy.goals)
    return tuple(Path(text) for text in dict.fromkeys(written) if os.path.isfile(text))


def digests(files: Iterable[Path]) -> dict[str, str]:
    """Hashes of the content of files, by their paths.

    Raises:
        ModelError: A file can't be read.
    """
    return {str(path): _digest(path) for path in files}


def _digest(path: Path) -> str:
    try:
        with path.open("rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()[:_DIGITS]
    except OSError as error:
        raise ModelError(f"{path} cannot be read ({error.strerror or error})") from error


def prompt_hashes(config: HyPerNavConfig) -> dict[str, str]:
    """A hash of the words of every question, by the question's kind."""
    words = {
        "ground": config.grounding.prompt,
        "crop": CROP_WORDS,
        "choose block": config.block_choice.words,
        "summarise": config.block_choice.summary_prompt,
        "verify": config.presence.prompt,
        "score view": config.chat_scorer.prompt,
        "choose images": config.image_recall.prompt,
        "choose arrow": f"{ONE_ARROW}\n{SEVERAL_ARROWS}",
        "choose direction": f"{DIRECTION}\n{DIRECTION_PAST}",
    }
    return {kind: prompt_hash(text) for kind, text in words.items()}
