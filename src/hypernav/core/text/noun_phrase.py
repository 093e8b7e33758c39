"""The words of a sentence that name a thing: "grey sofa" in "It is a grey sofa near the window".

Closed lists of English function words, and of the few verbs by which people say where a thing is.
Texts are in lower case with single spaces, as `hypernav.core.labels.normalise` gives them.
"""

import re

_DETERMINER = r"(?:the|an?|my|our|your|some|this|that|these|those)"
_BE = r"(?:is|are|was|were)"
_VERB = (
    rf"(?:{_BE}|ha[sd]|have|(?:can|could|may|might|should|will) be|stands|sits?|hangs?|lies?|leans?"
    r"|rests|faces|features|contains|holds|looks|appears|seems|belongs|serves|occupies)"
)
"""Never a name where something follows: "the tv stands here", but the plural "tv stands"."""
_PREPOSITION = (
    r"(?:above|across|against|along|among|around|at|behind|below|beneath|beside|between|beyond|by"
    r"|close to|for|from|(?<!walk )(?<!built )in|inside|into|like|near|next to|on|onto|opposite"
    r"|outside|over|through|towards?|under|underneath|upon|with|within|without"
    r"|(?:of|to)(?= (?:the|an?|my) ))"
)
"""Not those within a name: "walk-in closet", "built-in oven", "box of tissues"."""
_BEFORE_WHAT_IT_HAS = (
    r"(?:facing|containing|holding|featuring|showing|having|including|overlooking"
    r"|(?:made|full|consisting) of)"
)
_LEAD_IN = re.compile(
    rf"^(?:{_PREPOSITION} .*? (?:there )?{_VERB} (?={_DETERMINER} ))?"  # "in the hall there is a …"
    r"(?:(?:please|find|locate|(?:look|looking|search) for|(?:go|navigate) to) "
    rf"|(?:it|this|that|these|those|here|there)(?:['’]s| {_BE}) "
    rf"|(?:object|item|thing|target|goal)(?: to find)?(?: {_BE}|:) "
    rf"|(?:one|any|all|both|each) of (?={_DETERMINER} )"
    rf"|{_DETERMINER} )*"
)
_SENTENCE_END = re.compile(r"[.!?;:](?: |$)|[(–—]")
_PHRASE_END = re.compile(
    rf",? (?:{_PREPOSITION}|that|which|who|whose|where|{_BEFORE_WHAT_IT_HAS}|{_VERB}"
    rf"|(?:and|but)(?= (?:{_DETERMINER}|{_VERB}|{_PREPOSITION}|it|two|three|four) )) "
    rf"|, (?={_DETERMINER} )"
)
_TRAILING = re.compile(
    r"(?: (?:located|situated|placed|positioned|standing|sitting|hanging|lying|leaning|resting"
    r"|mounted|attached|fixed|installed|found|surrounded|covered|decorated|filled|used"
    r"|directly|immediately|just|right|left|also|both|adjacent|closest|nearest|far))+$"
)
"""What stands between a name and a preposition: "lamp hanging over", "couch right next to"."""


def without_lead_in(text: str) -> str:
    """A text without what only introduces a thing: "it is a", "there are", "the object is a"."""
    return _LEAD_IN.sub("", text, count=1) or text


def first_sentence(text: str) -> str:
    """What stands before the first end of a sentence."""
    return _SENTENCE_END.split(text, maxsplit=1)[0].strip()


def noun_phrase(text: str) -> str:
    """The words of a sentence before all that is said about the thing that they name.

    The last of them is the thing itself, those before it say of what kind it is or how it looks.
    """
    end = _PHRASE_END.search(text)
    named = text if end is None else text[: end.start()]
    return _TRAILING.sub("", named.replace(",", ""))
