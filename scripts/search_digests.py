"""Say whether a change of the code leaves every search as it was, byte for byte.

Run: python scripts/search_digests.py FILE before the change, and once more after it.

The first run writes a digest of the trace of each of 122 searches to the file; later ones compare.
They go over all agents, presets, detectors, reasoners and kinds of building, memories of several
searches, and robots over the network. What a trace holds of time is left out.
"""

import hashlib
import itertools
import json
import os
import subprocess
import sys
import tempfile
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Annotated, Any

import tyro

DATA = Path(os.environ.get("HYPERNAV_TEST_DATA", Path(__file__).parents[2] / "shared" / "data"))
YOLOX = f"yolox:{DATA / 'models' / 'yolox_nano.onnx'}"
HOUSE = next((DATA / "scenes" / "small_house").glob("*.glb"), None)
BUILDINGS = {
    "builtin": ("bed", "sofa", "chair", "tv"),
    "houses:3001": ("bed", "toilet", "refrigerator", "sofa"),
    "offices:3002": ("desk", "whiteboard", "plant", "refrigerator"),
    "shops:3003": ("chair", "plant", "refrigerator", "checkout"),
    "crowded:3004": ("bed", "tv", "chair", "table"),
    "storeys:3005": ("bed", "toilet", "sofa", "refrigerator"),
}
CLIMBING = ("--set", "embodiment.body.max_step_m=0.2")
VARIANTS: tuple[tuple[str, ...], ...] = (
    (),
    ("--preset", "paper"),
    ("--agent", "frontier"),
    ("--agent", "vlfm", "--reasoner", "truth"),
    ("--agent", "vlfm", "--preset", "vlfm-as-released", "--native"),
    ("--agent", "navvlm"),
    ("--agent", "navvlm", "--preset", "navvlm-as-released", "--native"),
    ("--agent", "vlmnav"),
    ("--agent", "vlmnav", "--preset", "vlmnav-as-released", "--native"),
    ("--agent", "pivot", "--preset", "pivot-as-released", "--native"),
    ("--agent", "dynavlm-style"),
    ("--detector", "noisy:fair"),
    ("--detector", YOLOX),
    ("--agent", "frontier", "--detector", YOLOX),
    ("--reasoner", "noisy:0.7"),
    (
        *("--set", "world.noise.depth_sigma_m=0.002", "world.noise.depth_edge_px=1"),
        *("world.noise.odometry_sigma=0.02", "world.noise.turn_sigma_deg=1.0"),
    ),
    ("--vlm", "openai:{server}"),
    ("--vlm", "openai:{server}", "--preset", "paper"),
    ("--vlm", "openai:{server}", "--agent", "navvlm"),
)
STEPS = 80


@dataclass(frozen=True)
class Search:
    """Commands, each of which gets a folder by ``--out``; the traces of all count."""

    name: str
    commands: tuple[tuple[str, ...], ...]


def main(file: Annotated[Path, tyro.conf.Positional], only: str = "", at_once: int = 2) -> None:
    """Write the digests, or compare with those of the file.

    Args:
        file: JSON file of the digests.
        only: Part of the names of the searches that are run.
        at_once: Number of searches at a time.
    """
    before: dict[str, str] = json.loads(file.read_text()) if file.exists() else {}
    chosen = [one for one in searches() if only in one.name]
    with ThreadingHTTPServer(("127.0.0.1", 0), _Model) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        address = f"http://127.0.0.1:{server.server_port}/v1"
        with ThreadPoolExecutor(at_once) as pool:
            digests = pool.map(lambda one: _digest(one, address), chosen)
            found = dict[str, str]()
            for number, (one, digest) in enumerate(zip(chosen, digests, strict=True), start=1):
                found[one.name] = digest
                old = before.get(one.name)
                fate = "new" if old is None else "same" if old == digest else "CHANGED"
                print(f"{number}/{len(chosen)} {fate} {digest[:24]} {one.name}", flush=True)
        server.shutdown()
    changed = [name for name, digest in found.items() if before.get(name, digest) != digest]
    if not before:
        file.write_text(json.dumps(found, indent=1) + "\n")
    sys.exit(f"{len(changed)} of {len(found)} changed" if changed else 0)


def searches() -> Iterator[Search]:
    """All searches."""
    buildings = itertools.cycle(BUILDINGS.items())
    for variant, turn in itertools.product(VARIANTS, range(5)):
        scene, goals = next(buildings)
        climbing = CLIMBING if scene.startswith("storeys") and "--native" not in variant else ()
        goal, seed = goals[turn % len(goals)], str(turn)
        words = ("find", goal, "--scene", scene, "--seed", seed, "--max-steps", str(STEPS))
        shown = " ".join((*words[1:], *variant)).replace(str(DATA), "")
        yield Search(shown, ((*words, *variant, *climbing),))
    for scene, goals in BUILDINGS.items():
        climbing = CLIMBING if scene.startswith("storeys") else ()
        life = [
            (
                "find",
                goal,
                "--scene",
                scene,
                "--seed",
                "5",
                "--memory",
                "{folder}/memory",
                *climbing,
            )
            for goal in goals[:3]
        ]
        yield Search(f"life {scene}", tuple(life))
    for goal, seed in itertools.product(("bed", "sofa", "chair", "tv"), ("0", "1", "2")):
        house = ("find", goal, "--scene", str(HOUSE), "--seed", seed)
        yield Search(f"small_house {goal} {seed}", (house,))
    for scene, goals in BUILDINGS.items():
        climbing = CLIMBING if scene.startswith("storeys") else ()
        words = ("robot", "simulate", goals[0], "--scene", scene, "--max-steps", str(STEPS))
        yield Search(f"robot {scene}", ((*words, *climbing),))
        if scene in {"builtin", "houses:3001", "offices:3002"}:
            yield Search(f"robot noise {scene}", ((*words, "--noise", "--motion", "continuous"),))


def _digest(search: Search, server: str) -> str:
    """The digest of a search's traces, or how it ended without one."""
    digest = hashlib.sha256()
    with tempfile.TemporaryDirectory() as folder:
        for number, command in enumerate(search.commands):
            words = [word.format(server=server, folder=folder) for word in command]
            out = Path(folder) / str(number)
            done = subprocess.run(
                [sys.executable, "-m", "hypernav", *words, "--out", str(out), "--quiet"],
                capture_output=True,
                text=True,
                check=False,
            )
            trace = next(out.rglob("trace.jsonl"), None)
            if trace is None:
                return f"status {done.returncode}: {done.stderr.strip()[-300:]}"
            for line in trace.read_text("utf-8").splitlines():
                digest.update(_timeless(json.loads(line)).encode())
    return digest.hexdigest()


def _timeless(value: Any) -> str:
    """A line of a trace without durations."""

    def without(one: Any) -> Any:
        if isinstance(one, dict):
            return {key: without(child) for key, child in one.items() if key != "seconds"}
        return [without(child) for child in one] if isinstance(one, list) else one

    return json.dumps(without(value), sort_keys=True)


class _Model(BaseHTTPRequestHandler):
    """A model whose answers are drawn by what it is sent."""

    protocol_version = "HTTP/1.1"

    def do_GET(self) -> None:
        """The list of models."""
        self._send({"object": "list", "data": [{"id": "Qwen2.5-VL-7B", "owned_by": "vllm"}]})

    def do_POST(self) -> None:
        """An answer."""
        body = self.rfile.read(int(self.headers["content-length"]))
        lot = hashlib.sha256(body).digest()
        said = ("yes", "no", "1", "2", "[]", "A: 3", '[{"bbox_2d": [80, 90, 300, 320]}]')
        message = {"role": "assistant", "content": said[lot[0] % len(said)]}
        choice = {"index": 0, "finish_reason": "stop", "message": message}
        self._send({"choices": [choice], "usage": {"prompt_tokens": 9, "completion_tokens": 3}})

    def _send(self, value: object) -> None:
        content = json.dumps(value).encode()
        self.send_response(200)
        self.send_header("content-type", "application/json")
        self.send_header("content-length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *args: object) -> None:
        """Say nothing."""


if __name__ == "__main__":
    tyro.cli(main)
