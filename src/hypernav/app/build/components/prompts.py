"""The words of all questions to a model, for the results."""

from hypernav.app.build.presets import HyPerNavConfig
from hypernav.search.perception.exchanges import prompt_hash
from hypernav.search.perception.local.yes_no_checks import CROP_WORDS
from hypernav.search.rivals.arrows.arrow_reasoners import ARROW_WORDS
from hypernav.search.rivals.navvlm.guides import DIRECTION_WORDS


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
        "choose arrow": ARROW_WORDS,
        "choose direction": DIRECTION_WORDS,
    }
    return {kind: prompt_hash(text) for kind, text in words.items()}
