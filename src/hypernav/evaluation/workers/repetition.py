"""Whether an episode that ran again went as it went before."""

from hypernav.core.errors import RepetitionError
from hypernav.evaluation.record import EpisodeRecord

_MAY_DIFFER = {"seconds", "saved"}


def check_repetition(first: EpisodeRecord, second: EpisodeRecord) -> None:
    """Make sure that two runs of an episode left the same record, times and folder aside.

    Raises:
        RepetitionError: They didn't; the message names every field that differs.
    """
    once, again = (record.model_dump(exclude=_MAY_DIFFER) for record in (first, second))
    differences = [f"{k} {once[k]!r}, then {again[k]!r}" for k in once if once[k] != again[k]]
    if differences:
        raise RepetitionError(
            f"episode {first.episode_id} of {first.scene_id} failed and ran again for its page; "
            f"equal runs were expected, but they differ: {'; '.join(differences)}. Make the agent "
            "repeatable (reset must bring everything back, random numbers included), or use "
            "--save videos or --save none, which run every episode once"
        )
