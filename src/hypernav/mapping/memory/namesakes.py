"""Which of the things that share a goal's name are likely to be the one that is asked for."""

from collections.abc import Sequence
from functools import lru_cache

from hypernav.core.goal import Goal
from hypernav.core.labels import ObjectLabel, asked_place
from hypernav.mapping.memory.thing import Thing, fit

LIKELY = 0.25
"""Chance to be the goal from which a thing is gone to before anything is explored."""
_AS_IF_ALONE = 5
"""Number of things that lack a word of the goal up to which each is as likely as one alone."""


def chances_by_name(things: Sequence[Thing], goal: Goal) -> list[tuple[Thing, float]]:
    """Those of some things that may be a goal by their names, each with the chance that it is.

    Where one that is likely has the goal's own name, or more words of it than others, other things
    of its kind are no candidates yet: a table lamp comes before a ceiling lamp. Of many that lack a
    word of it, each is the less likely: of twelve desks hardly any is the reception desk.

    Args:
        things: Things of the goal's kind, as far as their labels tell.
        goal: Goal.
    """
    lacking = {one.label for one in things if _lacks_a_word(one.label, goal)}
    count = sum(one.label in lacking for one in things)
    share = min(1.0, _AS_IF_ALONE / max(count, 1))
    chances = [
        (one, one.chance * one.fits(goal) * (share if one.label in lacking else 1.0))
        for one in things
    ]
    named = {one.number: _named_as(one.label, goal) for one in things}
    most = max((named[one.number] for one, chance in chances if chance >= LIKELY), default=None)
    return [pair for pair in chances if most is None or named[pair[0].number] >= most]


@lru_cache(maxsize=4096)
def _named_as(label: str, goal: Goal) -> tuple[float, int, bool]:
    """How well a label fits a goal, how many of its words name it, and whether as its own name.

    More is nearer: an armchair is called a chair only where there is no chair.
    """
    one = ObjectLabel(label)
    words = one.named_words(goal)
    return fit(label, goal), words, one.has_own_name_in(goal)


@lru_cache(maxsize=4096)
def _lacks_a_word(label: str, goal: Goal) -> bool:
    """Whether a goal's words, its place aside, say more than the kind that a label shares."""
    return 0 < ObjectLabel(label).named_words(goal) < len(asked_place(goal).before.split())
