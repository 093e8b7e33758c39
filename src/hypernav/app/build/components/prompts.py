"""The words of all questions to a model, for the results."""

from hypernav.app.build.presets import HyPerNavConfig
from hypernav.search.perception.config import CROP_WORDS
from hypernav.search.perception.exchanges import prompt_hash
from hypernav.search.rivals.config import DIRECTION, DIRECTION_PAST, ONE_ARROW, SEVERAL_ARROWS


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
