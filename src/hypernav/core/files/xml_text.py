"""Reading of XML from outside."""

import xml.etree.ElementTree as ElementTree

from hypernav.core.files.allowance import Allowance

_BYTES_PER_TAG = 300


def parse_xml(content: bytes, allowance: Allowance) -> ElementTree.Element:
    """The root element of a document; names of elements come without their namespace.

    Args:
        content: The document. White space before it is no fault.
        allowance: Memory that it may take.

    Raises:
        ValueError: It is not well-formed, or defines entities.
        OSError: It would take too much memory.
    """
    if b"<!ENTITY" in content.replace(b"\0", b""):  # also in UTF-16
        raise ValueError("it defines entities, which are not read")
    allowance.take(content.count(b"<") * _BYTES_PER_TAG, "its elements")
    try:
        root = ElementTree.fromstring(content.lstrip())
    except (ElementTree.ParseError, LookupError) as error:  # LookupError: an unknown encoding
        raise ValueError(f"is not well-formed XML: {error}") from error
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2]
    return root
