"""The goal types of GOAT-Bench: which can be run, and how their numbers are said."""

from collections.abc import Mapping, Sequence

from hypernav.core.episode import Episode
from hypernav.core.errors import EpisodeError

LONG_DESCRIPTION = "long description"
"""Goal type, here, of a description that the benchmark's code leaves out for its length."""
RUNNABLE = ("object", "description")
"""Goal types whose goals can be asked for in words."""

_WORDS = {
    "object": "category",
    "description": "description",
    "image": "image",
    LONG_DESCRIPTION: "over-long description",
}


def goal_types_in(text: str) -> tuple[str, ...]:
    """The goal types that an option names, separated by commas; all that can be run if none.

    Raises:
        EpisodeError: There is no such type, or its goals can't be run.
    """
    named = tuple(dict.fromkeys(part.strip() for part in text.split(",") if part.strip()))
    if "image" in named:
        raise EpisodeError(
            "--goal-types: image goals are read and counted, but can't be run yet; use "
            f"{','.join(RUNNABLE)}"
        )
    if unknown := [one for one in named if one not in RUNNABLE]:
        raise EpisodeError(
            f"--goal-types: there is no '{unknown[0]:.40}'; use {','.join(RUNNABLE)}"
        )
    return named or RUNNABLE


def of_types(
    episodes: Sequence[Episode], types: Sequence[str]
) -> tuple[list[Episode], dict[str, int]]:
    """The goals of some types, and the numbers of all others by type.

    Raises:
        EpisodeError: There is none of these types.
    """
    kept = [episode for episode in episodes if episode.group in types]
    if not kept:
        raise EpisodeError(
            f"--goal-types: none of the {len(episodes)} chosen goals is of {' or '.join(types)}"
        )
    others = [episode.group for episode in episodes if episode.group not in types]
    return kept, {kind: others.count(kind) for kind in sorted(set(others))}


def goal_type_words(counts: Mapping[str, int]) -> str:
    """Numbers of goals by type: "12 image goals, 2 description goals"."""
    return ", ".join(
        f"{count:,} {_WORDS.get(kind, kind)} goal{'' if count == 1 else 's'}"
        for kind, count in counts.items()
    )
