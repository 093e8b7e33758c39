"""Description of an object in words."""

from hypernav.core.labels import ObjectLabel


def describe(label: ObjectLabel) -> str:
    """Phrase with all that is known about an object, which is a goal that it satisfies.

    For example "teal fabric L-shaped sofa beside the coffee table in the living room".
    """
    words = [*label.attributes, label.category]
    other = next((o for o in label.beside if not label.is_named(o)), None)
    if other is not None:
        words.append(f"beside the {other}")
    if label.room:
        words.append(f"in the {label.room}")
    return " ".join(words)
