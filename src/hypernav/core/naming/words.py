"""Words: one form of equal texts, the words that name a thing, and numbers and texts for people.

Closed lists of English function words, and of the few verbs by which people say where a thing is,
tell a name from its sentence: "grey sofa" from "It is a grey sofa near the window". There texts are
in lower case with single spaces, as `hypernav.core.naming.labels.normalise` gives them.
"""

import re
import unicodedata

_LETTERS = re.compile("U+(?!L)|U?L+")
"""A word in the kinds of its characters: capitals, or small letters after at most one capital."""
_JOINERS = "\u200c\u200d"
"""What joins and separates letters within words of Persian and Indic scripts."""
_KINDS = {"Lu": "U", "Lt": "U", "Ll": "L", "Lm": "L", "Lo": "L"}

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

_MOST_DIGITS = 9

_OBEYED = re.compile(
    "[\x00-\x09\x0b-\x1f\x7f-\x9f"  # controls except the line feed
    "\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069"  # direction, and other line ends
    "\ud800-\udfff]"  # half of a surrogate pair, which cannot be encoded
)


def composed(text: str) -> str:
    """A text in Unicode's composed form (NFC): "ü" is one character, however it was typed."""
    return unicodedata.normalize("NFC", text)


def caseless(text: str) -> str:
    """The form of a text in which texts are equal that differ only in case or composition."""
    return composed(composed(text).casefold())


def words_within(name: str) -> list[str]:
    """The words of a name, in lower case: runs of letters with the marks that belong to them.

    A capital after a small letter begins a word, and so does the last one of several before a small
    letter: ``TVCabinet`` gives "tv" and "cabinet". Scripts without case are small letters.
    """
    name = composed(name)
    kinds = ""
    for character in name:
        category = unicodedata.category(character)
        belongs = category[0] == "M" or character in _JOINERS
        before = kinds[-1:].replace("U", "L")
        kinds += _KINDS.get(category, before if belongs and before else " ")
    return [name[word.start() : word.end()].lower() for word in _LETTERS.finditer(kinds)]


def is_single_letter(word: str) -> bool:
    """Whether a word is one letter of a script with case; one of another script may be a word."""
    return len(word) == 1 and word.upper() != word


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


def number_of(count: int, noun: str, plural: str = "") -> str:
    """A number with its noun, for example "1 episode" and "2 episodes"."""
    return f"{count:,} {noun if count == 1 else plural or f'{noun}s'}"


def megabytes(size: int) -> str:
    """A size for people, such as "2,000 MB"."""
    return f"{size // 1_000_000:,} MB" if size >= 10_000_000 else f"{size / 1e6:.2g} MB"


def is_whole_number(text: str) -> bool:
    """Whether a text is a whole number, 0 or more, of at most nine digits."""
    return text.isascii() and text.isdecimal() and len(text) <= _MOST_DIGITS


def visible(text: str) -> str:
    r"""The text with a Python escape such as ``\x1b`` for each control character.

    A server's error, a goal or a path may hold characters that a terminal or a browser executes
    instead of showing them: escape sequences, their one-character forms (C1), overrides of the
    reading direction. Texts are stored unchanged and made visible where they are shown: on the
    terminal by `hypernav.app.cli.screen.terminal`, on pages by `hypernav.app.show.templating`.
    """
    if text.isprintable():
        return text
    return _OBEYED.sub(lambda match: match[0].encode("unicode_escape").decode("ascii"), text)
