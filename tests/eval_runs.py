"""Small evaluations for tests: a room on disk, and the commands that run through it."""

import json
from pathlib import Path

import trimesh

from box_scenes import Box, room_boxes
from hypernav.core.episode import Episode, Outcome
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.lab.evaluation.failures import Failure
from hypernav.lab.evaluation.record import EpisodeRecord

SMALL = ("--set", "embodiment.camera.width=160", "embodiment.camera.height=120")

_TO_GLTF = [[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]]


def write_glb(path: Path, boxes: list[Box]) -> Path:
    """Boxes as a GLB whose nodes carry the names."""
    scene = trimesh.Scene()
    for number, (name, low, high) in enumerate(boxes):
        mesh = trimesh.creation.box(bounds=[low, high])
        mesh.apply_transform(_TO_GLTF)
        scene.add_geometry(mesh, node_name=f"{name or 'wall'}_{number:02d}")
    path.parent.mkdir(parents=True, exist_ok=True)
    scene.export(path)
    return path


def write_room(path: Path) -> Path:
    """A room with a bed and a sofa."""
    return write_glb(
        path,
        [
            *room_boxes(6.0, 4.0),
            ("bed", (4.0, 0.1, 0.0), (5.9, 1.7, 0.5)),
            ("sofa", (0.1, 2.6, 0.0), (1.9, 3.9, 0.7)),
        ],
    )


def write_exam(folder: Path) -> Path:
    """The exam of a model "qwen2.5-vl" that chooses blocks no better than the rule."""
    asked = {"ground": 80.0, "crop": 24.0, "choose block": 6.0, "verify": 1.0}
    cost = {"calls": 1.0, "seconds": 1.0, "tokens_in": 100.0, "tokens_out": 10.0}
    searches = {"preset": "default", "steps": 80.0, "seconds": 1.0, "asked": asked}
    exam = {
        "format": "hypernav-exam",
        "version": 2,
        "model": "qwen2.5-vl",
        "who": {"block": "vlm", "boxes": "vlm", "presence": "vlm", "model": "qwen2.5-vl"},
        "worth": {"presence": [[0.0, 0.1], [1.0, 0.9]], "boxes": [[1.0, 3.0]]},
        "predictions": [searches | {"leave_out": ["block"]}],
        "costs": dict.fromkeys(asked, cost),
    }
    path = folder / "exam.json"
    path.write_text(json.dumps(exam))
    return path


def spec(episode_id: str = "0", scene_id: str = "house") -> Episode:
    """An episode that nobody will really run."""
    return Episode(scene_id, episode_id, Goal("bed"), Pose2(0.0, 0.0, 0.0))


def record(episode_id: str = "0", scene_id: str = "house", **values) -> EpisodeRecord:
    """A success, unless the values say something else."""
    if values.get("failure") is not None:
        values = {"outcome": Outcome.NOT_FOUND, "success": False, "spl": 0.0} | values
    defaults = {
        "scene_id": scene_id,
        "episode_id": episode_id,
        "goal": "bed",
        "outcome": Outcome.FOUND,
        "failure": None,
        "success": True,
        "spl": 0.5,
        "soft_spl": 0.5,
        "distance_to_goal_m": 0.05,
        "shortest_path_m": 4.0,
        "path_length_m": 8.0,
        "stopped": True,
        "steps": 20,
        "model_calls": 0,
        "seconds": {"total": 1.0, "world": 0.6, "map": 0.1},
    }
    return EpisodeRecord.model_validate(defaults | values)


def apart(episode_id: str = "0", scene_id: str = "house") -> EpisodeRecord:
    """An episode that an outage ended."""
    return record(
        episode_id,
        scene_id,
        failure=Failure.MODEL_UNAVAILABLE,
        outcome=Outcome.MODEL_UNAVAILABLE,
        stopped=False,
    )


def timeless_lines(folder: Path) -> list[dict]:
    """What two runs of the same episodes must have in common, in a fixed order."""
    lines = [json.loads(line) for line in (folder / "episodes.jsonl").read_text().splitlines()]
    for line in lines:
        del line["seconds"]
    return sorted(lines, key=lambda line: (line["scene_id"], line["episode_id"]))
