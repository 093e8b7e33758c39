"""Page of an episode: one HTML file with video, map, decisions and results."""

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import quote

import yaml

from hypernav.app.show import captions, episode_summary, video_frame
from hypernav.app.show.climbs import (
    climb_words,
    climbs,
    floor_heights_m,
    floor_words,
    names_floors,
    whereabouts,
)
from hypernav.app.show.map_images import draw_result, final_view
from hypernav.app.show.spatial.cloud import ColouredCloud
from hypernav.app.show.spatial.view import library, search_view
from hypernav.app.show.templating import data_uri, image_uri, mode_name, page_environment, plain
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.trace import Mode, StepTrace, floor_of
from hypernav.search.drawing import palette

EMBED_LIMIT_BYTES = 2_400_000
"""Largest film in a page, which with it and the view in three dimensions stays below 5 MB."""
_MAP_SIZE = 960
_BAND_PX = {"desk": 1000.0, "phone": 300.0}
"""Least width of the band of floors by screen, pixels of the style sheet."""
_LETTER_PX = 7.5
"""Width of a letter in it, with its share of the margin."""
_FALLBACKS = {
    "geometric_choices": "blocks chosen by the geometric rule instead",
    "unsure_presence_checks": "checks neither yes nor no",
    "unsure_stop_checks": "answers whether to stop neither yes nor no",
    "unread_arrow_answers": "answers that named no arrow",
    "unread_image_answers": "answers that named no remembered image",
}
"""What became of unusable answers, by their counter in the result."""


@dataclass(frozen=True)
class _Metric:
    """One number of the result with its meaning."""

    label: str
    value: str
    meaning: str


def write_page(
    folder: Path,
    result: Mapping[str, Any],
    steps: Sequence[StepTrace],
    maps: Mapping[int, OccupancyGrid],
    *,
    video: Path | None = None,
    frame_counts: Sequence[int] | None = None,
    cloud: ColouredCloud | None = None,
    eye: list[list[float]] | None = None,
    embed_limit_bytes: int = EMBED_LIMIT_BYTES,
) -> Path:
    """Write ``index.html``: one page that needs no network.

    Args:
        folder: Folder of the page; created if missing.
        result: Content of ``result.json``; missing entries show as a dash.
        steps: Trace of the episode; may be empty.
        maps: Last map of every floor, by its number; empty if there is none.
        video: Video of the episode; by default ``episode.mp4`` in the folder, if it exists.
        frame_counts: Number of video frames of each step; by default that of a video of all steps.
        cloud: What the camera saw, for the view in three dimensions; None if it was not kept.
        eye: Position and corners of the camera beside the robot, see `search_view`.
        embed_limit_bytes: Largest video that is embedded; the page links to a larger one.

    Returns:
        Path of the page.
    """
    folder.mkdir(parents=True, exist_ok=True)
    if video is None and (folder / "episode.mp4").is_file():
        video = folder / "episode.mp4"
    template = page_environment().get_template("episode.html.j2")
    page = template.render(
        headline=captions.headline(result),
        summary=_summary(result),
        facts=_facts(result),
        has_ground_truth=captions.is_ground_truth(str(result.get("detector"))),
        video=_video_source(folder, video, embed_limit_bytes) if video is not None else "",
        maps=[_map(floor, maps[floor], steps) for floor in sorted(maps)],
        map_size=_MAP_SIZE,
        floors=_floors(steps),
        figures=_metrics(result, steps),
        phases=[_band(phase, len(steps)) for phase in episode_summary.phases(steps)],
        shares=episode_summary.mode_shares(steps),
        key_steps=episode_summary.key_steps(steps),
        entries=episode_summary.entries(episode_summary.key_steps(steps)),
        question_costs=episode_summary.question_costs(result),
        cost=_cost(result),
        fallbacks=_fallbacks(result),
        modules=episode_summary.module_times(result, steps),
        total_seconds=episode_summary.total_seconds(result),
        steps=steps,
        space=search_view(steps, maps, cloud, eye or []),
        library=library(),
        player=_player_data(steps, maps, frame_counts) | {"decisive": result.get("decisive_step")},
        configuration=_yaml(result.get("config")),
        captions=captions,
        mode_name=mode_name,
        ink_on=palette.ink_on,
        modes=palette.MODES,
    )
    path = folder / "index.html"
    path.write_text(page, encoding="utf-8")
    return path


def _video_source(folder: Path, video: Path, embed_limit_bytes: int) -> str:
    if video.stat().st_size > embed_limit_bytes:
        return quote(Path(os.path.relpath(video, folder)).as_posix())
    return data_uri(video.read_bytes(), "video/mp4")


def _map(floor: int, grid: OccupancyGrid, steps: Sequence[StepTrace]) -> dict[str, Any]:
    # The robot is drawn by the page itself, so that it can follow the video.
    image = draw_result(grid, steps, size=_MAP_SIZE, robot=False, floor=floor)
    words = floor_words(floor, floor_of(steps[0]) if steps else 1, floor_heights_m(steps))
    return {"floor": floor, "uri": image_uri(image), "words": words}


def _floors(steps: Sequence[StepTrace]) -> dict[str, Any]:
    """Floors and stairs as a band below the timeline, and as the chapters of the story.

    Both are empty for a search that knew of one floor only and was on no stairs.
    """
    if not names_floors(steps):
        return {"stays": [], "chapters": []}
    start, heights = floor_of(steps[0]), floor_heights_m(steps)
    names = {floor: floor_words(floor, start, heights) for floor in map(floor_of, steps)}
    climb_at = {one.first: climb_words(one, start, heights) for one in climbs(steps)}
    if steps[-1].mode is Mode.CLIMB:
        climb_at[max(climb_at)] += "; the search ended on them"
    return {
        "stays": [
            {
                "on_stairs": stay.on_stairs,
                "words": climb_at[stay.first] if stay.on_stairs else names[stay.floor],
                "steps": f"steps {stay.first + 1} to {stay.first + stay.count}",
            }
            | _extent(stay.first, stay.count, len(steps))
            | _band_names(stay, names[stay.floor], len(steps))
            for stay in episode_summary.stays(steps)
        ],
        "chapters": [
            {
                "is_folded": one.mode is not Mode.APPROACH,
                "mode": one.mode,
                "first": one.first,
                "words": climb_at[one.first] if one.mode is Mode.CLIMB else names[one.floor],
                "why": episode_summary.why_climbed(steps, one.first)
                if one.mode is Mode.CLIMB
                else "",
                "steps": f"steps {one.first + 1} to {one.first + one.count}",
                "entries": one.entries,
            }
            for one in episode_summary.chapters(steps)
        ],
    }


def _band_names(stay: episode_summary.Stay, words: str, total: int) -> dict[str, str]:
    """The name of a floor in the band, as much of it as has room on a screen and on a phone."""
    share, short = stay.count / total, f"Floor {stay.floor}"
    names = dict[str, str]()
    for screen, width_px in _BAND_PX.items():
        fitting = [one for one in (words, short) if _LETTER_PX * len(one) < share * width_px]
        names[screen] = fitting[0] if fitting and not stay.on_stairs else ""
    return names


def _band(phase: episode_summary.Phase, total: int) -> dict[str, Any]:
    extent = _extent(phase.first, phase.count, total)
    return {"mode": phase.mode, "first": phase.first, "count": phase.count} | extent


def _extent(first: int, count: int, total: int) -> dict[str, float]:
    """Where steps lie on the timeline, percent."""
    return {"left": 100.0 * first / total, "width": 100.0 * count / total}


def _player_data(
    steps: Sequence[StepTrace],
    maps: Mapping[int, OccupancyGrid],
    frame_counts: Sequence[int] | None,
) -> dict[str, Any]:
    """Data with which the page's script keeps video, timeline and map together."""
    if frame_counts is None:
        frame_counts = [video_frame.frame_count(step) for step in steps]
    robots, destinations = [], []
    views = {k: final_view(grid, steps, _MAP_SIZE, k) for k, grid in maps.items()}
    if maps:
        for step in steps:
            view = views.get(floor_of(step))
            if view is None:  # on a floor without a map
                robots.append(None)
                destinations.append(None)
                continue
            u, v = view.pixel_of(step.pose[0], step.pose[1])
            robots.append([round(u, 1), round(v, 1), round(-math.degrees(step.pose[2]), 1)])
            at = view.pixel_of(*step.destination) if step.destination is not None else None
            destinations.append([round(at[0], 1), round(at[1], 1)] if at is not None else None)
    return {
        "times": [round(time, 3) for time in video_frame.start_times(frame_counts)],
        "steps": [step.step + 1 for step in steps],
        "modes": [_doing(*one) for one in zip(steps, whereabouts(steps), strict=True)],
        "reasons": [captions.sentence(step.reason) for step in steps],
        "floors": [floor_of(step) for step in steps],
        "climbing": [step.mode is Mode.CLIMB for step in steps],
        "robots": robots,
        "destinations": destinations,
    }


def _doing(step: StepTrace, where: str) -> str:
    """What the robot does in a step, and where: "Exploring on floor 2"."""
    if step.mode is Mode.CLIMB:
        return captions.sentence(where)
    return f"{captions.MODES[step.mode]} {where}".rstrip()


def _summary(result: Mapping[str, Any]) -> str:
    """The episode in one or two sentences."""
    if result.get("outcome") == "replayed":
        return "Recorded frames went through mapping and local perception; nothing was driven."
    if result.get("steps") == 0:
        return "The search ended before its first step."
    earlier = (result.get("memory") or {}).get("earlier_searches", 0)
    been = f"where it had been in {earlier} earlier search{'' if earlier == 1 else 'es'}"
    text = f"The robot searched a building {been if earlier else 'that it had never seen'}"
    steps, walked = result.get("steps"), result.get("path_length_m")
    if isinstance(steps, int):
        text += f", for {steps} step{'' if steps == 1 else 's'}"
    if isinstance(walked, int | float):
        text += f", and walked {captions.number(walked, 1, 'm')}"
    shortest = result.get("shortest_path_m")
    text += "."
    if isinstance(shortest, int | float) and math.isfinite(shortest):
        text += f" The shortest path is {captions.number(shortest, 1, 'm')}."
    return text + captions.path_parts(result)


def _facts(result: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Agent, its components and scene, as name and value."""

    def known(name: str) -> str:
        return str(result.get(name) or "–")

    preset = f", {known('preset')} settings" if result.get("preset") else ""
    found = result.get("found_start")
    where = [] if found is None else [("Start in the memory", _start_in_memory(found))]
    return [
        ("Agent", known("agent") + preset),
        ("Sees with", captions.component_caption(known("detector"))),
        ("Segments with", known("segmenter")),
        ("Decides with", captions.component_caption(known("reasoner"))),
        ("Scene", known("scene")),
        *where,
    ]


def _start_in_memory(found: Mapping[str, Any]) -> str:
    if found["sure"]:
        return f"found on floor {found['floor']} by one turn"
    return f"not found: {found['doubt']}; the search began anew"


def _metrics(result: Mapping[str, Any], steps: Sequence[StepTrace]) -> list[_Metric]:
    read, written = episode_summary.tokens(steps)
    seconds = episode_summary.total_seconds(result)
    number, value = captions.number, result.get
    figures = [
        _Metric("Success", number(value("success")), "stopped where the goal is within reach"),
        _Metric("SPL", number(value("spl")), "success × shortest path ÷ path walked; 1 is perfect"),
        _Metric("SoftSPL", number(value("soft_spl")), "the same, with progress for success"),
        _Metric("Steps", number(value("steps")), "actions: forward, turn left, turn right, stop"),
        _Metric("Path walked", number(value("path_length_m"), 2, "m"), "length of the trajectory"),
        _Metric("Shortest path", number(value("shortest_path_m"), 2, "m"), "start to goal"),
        _Metric("Distance to goal", number(value("distance_to_goal_m"), 2, "m"), "at the end"),
        _Metric("Model calls", number(value("model_calls")), "questions put to neural networks"),
    ]
    if steps and steps[-1].floor is not None:
        floors = len(set(map(floor_of, steps)))
        figures.append(_Metric("Floors", str(floors), "that the robot was on"))
    if seconds is not None:
        figures.append(_Metric("Time", captions.duration(seconds), "that the run took in all"))
    if read or written:
        figures.append(_Metric("Tokens", f"{read:,} + {written:,}", "read + written by models"))
    return figures


def _cost(result: Mapping[str, Any]) -> str:
    """Cost of the tokens; empty if no price is known."""
    cost = (result.get("ledger") or {}).get("cost")
    return f"{cost:.4f}" if isinstance(cost, int | float) else ""


def _fallbacks(result: Mapping[str, Any]) -> str:
    """Fallbacks for unusable answers, in one sentence; empty if there were none."""
    counts = result.get("fallbacks") or {}
    boxes = counts.get("rejected_boxes") or {}
    uses = [f"{count} boxes or answers about the image {why}" for why, count in boxes.items()]
    uses += [f"{counts[name]} {words}" for name, words in _FALLBACKS.items() if counts.get(name)]
    return "; ".join(uses)


def _yaml(configuration: object) -> str:
    if not configuration:
        return ""
    return yaml.safe_dump(plain(configuration), sort_keys=False, allow_unicode=True)
