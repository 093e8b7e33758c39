"""Count searches whose detector errs: the same searches of training buildings, for every variant.

A set of searches is fixed by its name. "known" asks only for kinds that COCO's detectors know: four
searches in each of ten houses, offices and shops, every one for another kind, and five starts for
each of six kinds in a scene file. "any" are the first searches of each kind of building, and of
offices with crowded meeting rooms.

    python benchmarks/weak_eyes.py run known before.jsonl --detector yolox:yolox_nano.onnx
    python benchmarks/weak_eyes.py run known after.jsonl --detector yolox:yolox_nano.onnx \
        --set local.target=latest
    python benchmarks/weak_eyes.py compare before.jsonl after.jsonl
"""

import multiprocessing
import os
from collections import Counter, defaultdict
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from pathlib import Path
from typing import Literal

import numpy as np
import tyro
from many_searches import GOALS, SMALL_HOUSE
from scipy.stats import bootstrap

from hypernav.app.build.components.component_specs import ComponentSpecs, PresetName
from hypernav.app.build.data.datasets import load_episodes
from hypernav.app.build.presets import preset as preset_named
from hypernav.core.episode import Episode
from hypernav.core.naming.labels import same_name
from hypernav.io.layered_config import layered
from hypernav.lab.evaluation.record import EpisodeRecord
from hypernav.lab.evaluation.workers.job import Job
from hypernav.lab.evaluation.workers.worker import EpisodeWorker
from hypernav.search.models.closed_set import COCO_CLASSES

KINDS = ("houses", "offices", "shops")
SetName = Literal["known", "any"]
Settings = tuple[str, str | None, PresetName, tuple[str, ...], int]


def searches(name: SetName, buildings: int, each: int) -> list[Episode]:
    """The searches of a set, building by building."""
    if name == "any":
        return [
            episode
            for kind in (*KINDS, "crowded")
            for episode in _spread(load_episodes(f"{kind}-train#0:{buildings}"), each)
        ]
    known = [
        episode
        for kind in KINDS
        for episode in load_episodes(f"{kind}-train#0:{buildings}")
        if is_known(episode)
    ]
    chosen = _spread(known, each)
    if SMALL_HOUSE.is_file():
        there = load_episodes(f"scene:{SMALL_HOUSE}#5")
        chosen += [one for one in there if one.goal.text in GOALS and is_known(one)]
    return chosen


def is_known(episode: Episode) -> bool:
    return any(same_name(episode.goal.thing, one) for one in COCO_CLASSES)


def _spread(episodes: list[Episode], each: int) -> list[Episode]:
    """So many episodes of every building, of different goals as long as there are any."""
    by_scene: dict[str, list[Episode]] = defaultdict(list)
    for episode in episodes:
        by_scene[episode.scene_id].append(episode)
    chosen = []
    for here in by_scene.values():
        times: Counter[str] = Counter()
        ranked = []
        for place, episode in enumerate(here):
            ranked.append((times[episode.goal.text], place, episode))
            times[episode.goal.text] += 1
        chosen += [episode for *_, episode in sorted(ranked, key=lambda one: one[:2])[:each]]
    return chosen


@cache
def worker_of(settings: Settings) -> EpisodeWorker:
    agent, detector, preset, assignments, seed = settings
    config = layered(preset_named(preset), assignments=assignments)
    return EpisodeWorker(Job(Path(), config, ComponentSpecs(agent=agent, detector=detector), seed))


def run_one(settings: Settings, episode: Episode) -> EpisodeRecord:
    return worker_of(settings).run(episode)


def run(
    which: tyro.conf.Positional[SetName],
    out: tyro.conf.Positional[Path],
    detector: str | None = None,
    agent: str = "hypernav",
    preset: PresetName = "default",
    set: tuple[str, ...] = (),
    buildings: int = 10,
    each: int = 4,
    seed: int = 0,
    workers: int = 2,
    part: tuple[int, int] | None = None,
) -> None:
    """Run a set of searches, and keep a line of each.

    Args:
        which: Name of the set.
        out: File to write.
        detector: The detector, as for `hypernav eval --detector`.
        agent: The agent.
        preset: The preset.
        set: Single values of the configuration, as for `hypernav eval --set`.
        buildings: Number of buildings of each kind.
        each: Number of searches in each building.
        seed: Seed of the noise.
        workers: Number of processes.
        part: Only every so many of them: the first, and the distance to the next.
    """
    os.environ["OMP_NUM_THREADS"] = os.environ["NUMBA_NUM_THREADS"] = "1"
    chosen = searches(which, buildings, each)
    if part is not None:
        chosen = chosen[part[0] :: part[1]]
    settings: Settings = (agent, detector, preset, set, seed)
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(workers, mp_context=context) as pool, out.open("w") as lines:
        for record in pool.map(run_one, [settings] * len(chosen), chosen, chunksize=2):
            lines.write(record.model_dump_json() + "\n")
            lines.flush()
    tell(out)


def _read(file: Path) -> dict[tuple[str, str], EpisodeRecord]:
    lines = file.read_text().splitlines()
    return {one.key: one for one in map(EpisodeRecord.model_validate_json, lines)}


def kind_of(record: EpisodeRecord) -> str:
    return record.scene_id.partition(":")[0] if ":" in record.scene_id else "scene file"


def tell(file: tyro.conf.Positional[Path]) -> None:
    """Success, SPL and failures of a file."""
    records = list(_read(file).values())
    for kind in ("all", *dict.fromkeys(map(kind_of, records))):
        of = [one for one in records if kind in ("all", kind_of(one))]
        stops = [one for one in of if one.stopped]
        wrong = [one for one in stops if one.failure in ("false_detection", "language")]
        failures = Counter(str(one.failure) for one in of if one.failure is not None)
        print(
            f"{kind:11s} n {len(of):3d}  SR {np.mean([o.success for o in of]):.3f}  "
            f"SPL {np.mean([o.spl for o in of]):.3f}  steps {np.mean([o.steps for o in of]):.0f}  "
            f"false STOPs {len(wrong)} of {len(stops)}  {dict(failures.most_common())}"
        )


def compare(files: tyro.conf.Positional[tuple[Path, ...]]) -> None:
    """Every file beside the first, on the searches that all of them have."""
    runs = {file: _read(file) for file in files}
    keys = sorted(set.intersection(*map(set, runs.values())))
    first = runs[files[0]]
    for file, records in runs.items():
        spl = np.array([[records[key].spl, first[key].spl] for key in keys])
        success = np.array([[records[key].success, first[key].success] for key in keys])
        ratio = spl[:, 0].sum() / max(spl[:, 1].sum(), 1e-9)
        print(
            f"{file.stem:28s} n {len(keys)}  SR {success[:, 0].mean():.3f}  "
            f"SPL {spl[:, 0].mean():.3f}  ratio {ratio:.3f} {_interval(spl)}  "
            f"won {(success[:, 0] > success[:, 1]).sum()} "
            f"lost {(success[:, 0] < success[:, 1]).sum()}"
        )


def _interval(pairs: np.ndarray) -> str:
    """The 95 % interval of the ratio of two sums, over the searches."""
    if (pairs[:, 0] == pairs[:, 1]).all():
        return ""
    low, high = bootstrap(
        (pairs[:, 0], pairs[:, 1]),
        lambda a, b, axis: a.sum(axis=axis) / np.maximum(b.sum(axis=axis), 1e-9),
        paired=True,
        vectorized=True,
        method="percentile",
        rng=np.random.default_rng(0),
    ).confidence_interval
    return f"[{low:.2f}, {high:.2f}]"


if __name__ == "__main__":
    tyro.extras.subcommand_cli_from_dict({"run": run, "tell": tell, "compare": compare})
