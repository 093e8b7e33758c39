"""Episode files, recordings, run folders and descriptions of objects, with something changed."""

import gzip
import json
from collections.abc import Callable
from typing import Any

EPISODES: dict[str, Any] = {
    "episodes": [
        {
            "episode_id": 1,
            "scene_id": "builtin",
            "start_position": [0.0, 0.0, 0.0],
            "start_rotation": [0.0, 0.0, 0.0, 1.0],
            "object_category": "chair",
            "info": {"geodesic_distance": 1.0},
        }
    ],
    "goals_by_category": {
        "builtin_chair": [
            {
                "object_category": "chair",
                "object_id": 1,
                "position": [1.0, 0.0, 1.0],
                "view_points": [
                    {
                        "agent_state": {
                            "position": [1.0, 0.0, 1.0],
                            "rotation": [0.0, 0.0, 0.0, 1.0],
                        },
                        "iou": 0.5,
                    }
                ],
            }
        ]
    },
}
"""A sound episode file."""

OBJECTS: dict[str, Any] = {
    "objects": [
        {"name": "c", "category": "chair", "nodes": ["chair"], "synonyms": ["seat"], "room": "hall"}
    ]
}
"""A sound description of the scene of `hostile_scenes`."""

EXCHANGE: dict[str, Any] = {
    "question": {
        "kind": "ground",
        "text": "where?",
        "images": ["ab"],
        "allowed": [],
        "form": None,
        "max_tokens": 10,
    },
    "answer": {
        "text": "there",
        "model": "m",
        "tokens_in": 1,
        "tokens_out": 1,
        "seconds": 0.5,
        "lost": {"timeout": 1},
        "probabilities": {"a": 0.5},
        "refused": False,
        "unavailable": "",
    },
}
"""A sound exchange of a recording."""

HEADER = {"format": "hypernav-recording", "version": 1, "model": "m"}

RUN: dict[str, Any] = {
    "hypernav": "0",
    "dataset": "builtin",
    "selection": {},
    "episodes": {"count": 1, "scenes": 1, "fingerprint": "a"},
    "who": {"agent": "hypernav", "preset": "default", "parts": {}},
    "protocol": {"max_steps": 1, "success_distance_m": 0.1, "stop_rule": "stop", "seed": 0},
    "config": {"embodiment": {}},
}
"""The configuration of a run."""

PACKED: dict[str, Callable[[], bytes]] = {
    "bomb": lambda: gzip.compress(b" " * 600_000_000, 1),
    "bomb in a bomb": lambda: gzip.compress(gzip.compress(b"\0" * 50_000_000)),
    "cut off": lambda: gzip.compress(json.dumps(EPISODES).encode())[:-12],
    "wrong sum": lambda: gzip.compress(json.dumps(EPISODES).encode())[:-8] + bytes(8),
    "header": lambda: b"\x1f\x8b",
    "not packed": lambda: b"\x1f\x8b" + bytes(100),
    "dense": lambda: gzip.compress(b'{"episodes":[' + b"[]," * 12_000_000 + b"[]]}", 1),
}
"""Episode files that are compressed; only the test of one takes the seconds to make it."""


def recording(exchange: Any) -> bytes:
    """A recording of one exchange."""
    return f"{json.dumps(HEADER)}\n{json.dumps(exchange)}\n".encode()
