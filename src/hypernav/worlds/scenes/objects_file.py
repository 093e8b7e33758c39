"""Reads ``objects.json``: the objects that the nodes of a scene form."""

from pathlib import Path
from typing import Annotated

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, FiniteFloat, ValidationError

from hypernav.core.errors import SceneError
from hypernav.core.labels import ObjectLabel
from hypernav.core.words import composed
from hypernav.io.parsing import Items, parse_json
from hypernav.io.reading import read_file
from hypernav.worlds.scenes.scene_assembly import SceneObject


class _Object(BaseModel):
    model_config = ConfigDict(frozen=True)

    name: str = Field(min_length=1)
    category: str = Field(min_length=1)
    structural: bool = False
    nodes: list[Annotated[str, AfterValidator(composed)]] = Field(min_length=1)
    synonyms: list[str] = Field(default_factory=list)
    attributes: list[str] = Field(default_factory=list)
    room: str = ""
    beside: list[str] = Field(default_factory=list)


class _Objects(BaseModel):
    objects: Items[_Object]
    storeys: Items[FiniteFloat] = Field(default_factory=list)


def read_objects(path: Path, node_names: set[str]) -> tuple[list[SceneObject], tuple[float, ...]]:
    """Objects that a file describes, and the heights of its storeys as `Scene` holds them.

    Every object has ``name``, ``category`` and ``nodes``, and may have ``structural``,
    ``synonyms``, ``attributes``, ``room`` and ``beside``; other keys are ignored. Parts of the
    building have no label. A building with stairs may have ``storeys``, the heights of its floors.

    Args:
        path: Path of the JSON file.
        node_names: Names of the scene's nodes.

    Raises:
        SceneError: The file cannot be read, lacks something, or doesn't belong to the scene.
    """
    try:
        parsed = _Objects.model_validate(parse_json(read_file(path)))
    except OSError as error:
        raise SceneError(f"{path}: cannot be read ({error.strerror or error})") from error
    except ValidationError as error:
        first = error.errors()[0]
        location = ".".join(str(part) for part in first["loc"]) or "file"
        raise SceneError(
            f"{path}: {location}: {first['msg']}; every object needs name, category and nodes"
        ) from error
    except ValueError as error:
        raise SceneError(
            f"{path}: is not valid JSON ({error}); correct it, or remove it to label objects "
            "by the names of their nodes"
        ) from error
    _check_nodes(path, parsed.objects, node_names)
    objects = [SceneObject(o.name, frozenset(o.nodes), _label(o)) for o in parsed.objects]
    return objects, tuple(sorted(parsed.storeys))


def _label(item: _Object) -> ObjectLabel | None:
    if item.structural:
        return None
    return ObjectLabel(
        item.category,
        tuple(item.synonyms),
        tuple(item.attributes),
        item.room,
        tuple(item.beside),
    )


def _check_nodes(path: Path, objects: list[_Object], node_names: set[str]) -> None:
    """Check that every object's nodes exist and belong only to it, and that names are unique."""
    owner: dict[str, str] = {}
    names: set[str] = set()
    for item in objects:
        if item.name in names:
            raise SceneError(f"{path}: two objects are named {item.name!r}; give each its own name")
        names.add(item.name)
        for node in item.nodes:
            if node not in node_names:
                raise SceneError(
                    f"{path}: object {item.name!r} names the node {node!r}, which the scene does "
                    "not have; the file belongs to another scene or is out of date, "
                    "write it again or remove it"
                )
            if node in owner and owner[node] != item.name:
                raise SceneError(
                    f"{path}: node {node!r} belongs to both {owner[node]!r} and {item.name!r}; "
                    "list it once"
                )
            owner[node] = item.name
