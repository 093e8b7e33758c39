"""Words of any script: one form of equal texts, and the words within names."""

import re
import unicodedata

_LETTERS = re.compile("U+(?!L)|U?L+")
"""A word in the kinds of its characters: capitals, or small letters after at most one capital."""
_JOINERS = "\u200c\u200d"
"""What joins and separates letters within words of Persian and Indic scripts."""
_KINDS = {"Lu": "U", "Lt": "U", "Ll": "L", "Lm": "L", "Lo": "L"}


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
