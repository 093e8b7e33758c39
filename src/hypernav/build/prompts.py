"""The words of all questions that the configuration holds, for the results."""

from hypernav.build.presets import HyPerNavConfig
from hypernav.perception.prompt_text import prompt_hash


def prompt_hashes(config: HyPerNavConfig) -> dict[str, str]:
    """A hash of the words of every question, by the question's kind."""
    words = {
        "ground": config.grounding.prompt,
        "choose block": config.block_choice.words,
        "summarise": config.block_choice.summary_prompt,
        "verify": config.presence.prompt,
        "score view": config.chat_scorer.prompt,
    }
    return {kind: prompt_hash(text) for kind, text in words.items()}
