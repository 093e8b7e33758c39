"""A whole data folder with one scene and the episodes of every benchmark."""

from pathlib import Path

from scan_writers.buildings import STOREY_M, three_storeys, two_storeys
from scan_writers.episodes import HASH, SCENE, episode, write_split
from scan_writers.goat import goat_life, objects_of, write_goat
from scan_writers.matterport import write_annotation
from scan_writers.scans import write_scan, write_visual

BELOW, ABOVE, TOP = (3.0, 3.0, 0.0), (5.0, 3.0, STOREY_M), (5.0, 3.0, 2 * STOREY_M)


def write_data(folder: Path) -> Path:
    """Every benchmark over a house of two storeys, as habitat-lab lays them out."""
    house = two_storeys()
    scenes, tasks = folder / "scene_datasets", folder / "datasets"
    write_scan(house, scenes / "hm3d" / "val" / SCENE)
    write_visual(house, scenes / "mp3d" / HASH / f"{HASH}.glb")
    write_annotation(house, scenes / "mp3d" / HASH)
    for version, release in (("v1", "hm3d"), ("v2", "hm3d_v0.2")):
        scene_id = f"{release}/val/{SCENE}/{HASH}.basis.glb"
        found = [
            episode(0, scene_id, "chair", BELOW, 0.5),
            episode(1, scene_id, "plant", BELOW),
            episode(2, scene_id, "tv_monitor", ABOVE, 1.0),
            episode(3, scene_id, "sofa", ABOVE),
        ]
        write_split(tasks / "objectnav" / "hm3d" / version / "val", house, found)
    scene_id = f"mp3d/{HASH}/{HASH}.glb"
    found = [episode(0, scene_id, "bed", BELOW), episode(1, scene_id, "tv_monitor", ABOVE)]
    write_split(tasks / "objectnav" / "mp3d" / "v1" / "val", house, found)
    scene_id = f"hm3d/val/{SCENE}/{HASH}.basis.glb"
    for split in ("val_seen", "val_seen_synonyms", "val_unseen"):
        found = [
            episode(0, scene_id, "bed", BELOW, children_object_categories=[]),
            episode(1, scene_id, "sofa", ABOVE, children_object_categories=["tv_monitor"]),
        ]
        write_split(tasks / "ovon" / "hm3d" / split, house, found, textual=True)
    objects = objects_of(house)
    (chair,) = (one["object_id"] for one in objects if one["object_category"] == "chair")
    rows = [
        *(("bed", "object", None), ("chair", "description", chair), ("bed", "object", None)),
        ("chair", "image", chair, 0, 0),
    ]
    lives = [goat_life(0, scene_id, BELOW, rows)]
    for split in ("val_seen", "val_seen_synonyms", "val_unseen"):
        write_goat(tasks / "goat_bench" / "hm3d" / "v1" / split, lives, objects)
    return folder


def write_tower(folder: Path) -> Path:
    """HM3D's v1 over a house of three storeys: up two floors, up one, and down one."""
    house = three_storeys()
    write_scan(house, folder / "scene_datasets" / "hm3d" / "val" / SCENE)
    scene_id = f"hm3d/val/{SCENE}/{HASH}.basis.glb"
    found = [
        episode(0, scene_id, "bed", BELOW, 0.5),
        episode(1, scene_id, "bed", ABOVE),
        episode(2, scene_id, "tv_monitor", TOP),
    ]
    write_split(folder / "datasets" / "objectnav" / "hm3d" / "v1" / "val", house, found)
    return folder
