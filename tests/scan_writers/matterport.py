"""The annotation of Matterport3D's scenes: ``.house`` and ``_semantic.ply``, object 0 first."""

from pathlib import Path

import numpy as np

from scan_writers.buildings import House, Thing
from scan_writers.scans import mesh_of


def write_annotation(house: House, folder: Path) -> None:
    """Write both files beside the mesh that is named as the folder."""
    text = "\n".join(house_lines(house)) + "\n"
    (folder / f"{folder.name}.house").write_text(text)
    (folder / f"{folder.name}_semantic.ply").write_bytes(semantic_ply(house))


def house_lines(house: House) -> list[str]:
    """Records of a house (Matterport's data_organization.md): a level, regions, objects."""
    regions = sorted({thing.region for thing in house.things})
    words = sorted({(thing.category, thing.task or thing.category) for thing in house.things})
    lines = [
        "ASCII 1.1",
        f"H x x 0 0 0 0 0 {len(house.things)} {len(words)} {len(regions)} 0 1 "
        "0 0 0 0 0 0 0 0 9 9 6 0 0 0 0 0",
        f"L 0 {len(regions)} x 0 0 0 0 0 0 9 9 6 0 0 0 0 0",
    ]
    lines += [f"R {region} 0 0 0 z 1 1 1 0 0 0 9 9 3 3 0 0 0 0" for region in regions]
    for number, (own, common) in enumerate(words):
        lines.append(f"C {number} 7 {own.replace(' ', '#')} 9 {common.replace(' ', '_')} 0 0 0 0 0")
    for number, thing in enumerate(house.things):
        middle = [(low + high) / 2.0 for low, high in zip(thing.low, thing.high, strict=True)]
        sides = [(high - low) / 2.0 for low, high in zip(thing.low, thing.high, strict=True)]
        category = words.index((thing.category, thing.task or thing.category))
        numbers = " ".join(f"{value:.4f}" for value in (*middle, 1, 0, 0, 0, 1, 0, *sides))
        lines.append(f"O {number} {thing.region} {category} {numbers} 0 0 0 0 0 0 0 0")
        lines.append(f"E {number} {number} {number} 1.0 0 0 0 0 0 0 1 1 1 0 0 0 0 0")
    return lines


def semantic_ply(house: House) -> bytes:
    """Triangles with the number of their object; colours are drawn at random."""
    positions, _, triangles = mesh_of(house.things)
    vertex = np.zeros(len(positions), [("position", "<f4", 3), ("color", "u1", 3)])
    vertex["position"] = positions
    vertex["color"] = np.random.default_rng(0).integers(0, 256, (len(positions), 3))
    face = np.zeros(
        len(triangles) // 3, [("count", "u1"), ("corners", "<i4", 3), ("object", "<i4")]
    )
    face["count"], face["corners"] = 3, triangles.reshape(-1, 3)
    face["object"] = np.arange(len(face)) // 12
    header = [
        "ply",
        "format binary_little_endian 1.0",
        f"element vertex {len(vertex)}",
        *(f"property float {axis}" for axis in "xyz"),
        *(f"property uchar {channel}" for channel in ("red", "green", "blue")),
        f"element face {len(face)}",
        "property list uchar int vertex_indices",
        "property int object_id",
        "end_header",
    ]
    return ("\n".join(header) + "\n").encode() + vertex.tobytes() + face.tobytes()


def name_of(house: House, thing: Thing) -> str:
    """Name of an object in the episode files."""
    return f"0_{thing.region}_{house.things.index(thing)}"
