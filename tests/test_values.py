"""What holds for all settings and values of the rooms that the robot runs."""

import importlib
import json
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

from pydantic import TypeAdapter

from hypernav.core.config import Curve, ProbabilityCurve, RoomConfig

SOURCE = Path(__file__).parents[1] / "src"
ROOMS = ("core", "search")
SETTINGS = Path(__file__).with_name("settings.json")

CHANGING = {
    *("SearchMemory", "Floor", "KeyImages", "CoverageMask", "LedgerRow"),
    *("_Forgotten", "_Notes"),
    # Components, which keep counts and caches.
    *("YesNoAsker", "RandomReasoner", "NoisyReasoner", "VlmReasoner", "ImageRanking"),
    *("ImageRecall", "VlmPresenceCheck", "ChatArrowReasoner", "ChatStopCheck", "ChatScorer"),
}
"""The data classes whose values change; all others are frozen."""
NOT_ZERO = {
    "ArrowStyle.disc_px": 34.0,
    "ArrowStyle.shaft_px": 5.0,
    "ArrowStyle.shafts": True,
    "ArrowStyle.text_px": 44.0,
    "ArrowView.wanted": 1,
    "Candidate.needed": float("-inf"),
    "Climbing.farthest_m": float("-inf"),
    "Connector.sightings": 1,
    "Contents.most_bytes": 50_000_000,
    "Detection.is_goal": True,
    "Episode.max_steps": 500,
    "Episode.success_distance_m": 0.1,  # Habitat's ObjectNav challenge
    "GroundTruthDetector.min_area_share": 0.0005,
    "Item.score": 1.0,
    "MapOverview.seen_m2": float("inf"),
    "Overview.seen_m2": float("inf"),
    "Plan.full_turn": True,
    "Progress.shortest_m": float("inf"),
    "Question.max_tokens": 256,
    "Route.clearance_m": float("inf"),
    "Route.next_waypoint": 1,  # the robot stands at the first
    "SearchMemory.has_new_view": True,
    "ServerDialect.logprobs": 20,  # the most that OpenAI's interface allows
    "ServerDialect.streams": True,
    "Thing.seen": 1,
    "VlmFamily.max_pixels": 16384 * 28 * 28,  # Qwen2-VL's own limits
    "VlmFamily.min_pixels": 56 * 56,
}
"""What a fresh value doesn't count from zero, and what is so from the start."""


def modules() -> Iterator[ModuleType]:
    """All modules of the rooms that import without the packages of extras."""
    for path in (path for room in ROOMS for path in (SOURCE / "hypernav" / room).rglob("*.py")):
        name = ".".join(path.relative_to(SOURCE).with_suffix("").parts)
        yield importlib.import_module(name)


CLASSES = {
    one
    for module in modules()
    for one in vars(module).values()
    if isinstance(one, type) and one.__module__ == module.__name__
}
DATA_CLASSES: set[Any] = {one for one in CLASSES if is_dataclass(one)}


def settings() -> dict[str, object]:
    """The form, default and bounds of each setting, as JSON Schema has them."""
    models = sorted(
        (one for one in CLASSES if issubclass(one, RoomConfig)), key=lambda one: one.__name__
    )
    return {
        f"{model.__name__}.{name}": {key: said[key] for key in said if key != "title"}
        for model in models
        for name, said in model.model_json_schema().get("properties", {}).items()
    }


def starts(kind: type) -> dict[str, object]:
    """What the numbers and switches of a fresh value are, unless told."""
    return {
        f"{kind.__name__}.{one.name}": one.default
        for one in fields(kind)
        if isinstance(one.default, bool | int | float)
    }


def test_settings_keep_their_defaults_and_bounds():
    """Results were measured with these; what changes is written down in the file, too."""
    assert settings() == json.loads(SETTINGS.read_text("utf-8"))


def test_the_default_of_a_setting_lies_within_its_bounds():
    for model in (one for one in CLASSES if issubclass(one, RoomConfig)):
        wanted = {name for name, said in model.model_fields.items() if said.is_required()}
        if not wanted:
            assert model.model_validate(model().model_dump()) == model()


def test_only_these_values_change():
    changing = {one.__name__ for one in DATA_CLASSES if not one.__dataclass_params__.frozen}
    assert changing == CHANGING


def test_fresh_values_count_from_zero_and_nothing_is_so_yet():
    found = {name: value for one in DATA_CLASSES for name, value in starts(one).items() if value}
    assert found == NOT_ZERO


def test_every_curve_rises():
    for module in modules():
        for name, kind in getattr(module, "__annotations__", {}).items():
            if kind in (Curve, ProbabilityCurve):
                TypeAdapter(kind).validate_python(getattr(module, name))
