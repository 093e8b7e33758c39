"""Which switches cannot matter with the components in use, and why."""

from hypernav.build.construction import asked_by
from hypernav.build.registries import COMPONENTS
from hypernav.core.components.abilities import answers_at_once
from hypernav.core.errors import ConfigError
from hypernav.evaluation.ablation.config_fields import differing_fields
from hypernav.evaluation.ablation.study import Method, Variant

_DRAWN = frozenset(
    f"overview.{key}"
    for key in (
        "image_px",
        "strong_colors",
        "draw_frontier",
        "fill_obstacles",
        "clear_numbers",
        "label_things",
    )
)
_ASKED = frozenset(f"block_choice.{key}" for key in ("mode", "facts", "list_excluded"))
_ABOUT_EROSION = frozenset({"local.erosion_px", "local.keep_thin_masks"})


def why_idle(variant: Variant, method: Method) -> str:
    """The reason why a variant of a method cannot differ from it; empty if it can."""
    varied = method.varied(variant)
    fields = differing_fields(method.config, varied.config)
    try:
        same_components = varied.chosen.as_dict() == method.chosen.as_dict()
    except ConfigError as error:
        return str(error)
    reasons = [why_unread(field, method) for field in fields]
    if not all(reasons):
        return ""
    if varied.specs != method.specs and not same_components:
        return ""
    return reasons[0] if reasons else "it is so already"


def why_unread(field: str, method: Method) -> str:
    """The reason why nothing in use reads a field; empty if something does.

    Args:
        field: Full name of the field.
        method: Method, whose components decide.
    """
    chosen, local = method.chosen, method.config.local
    section = field.partition(".")[0]
    asks_model = chosen.reasoner is not None and "chat" in asked_by(chosen.reasoner)
    if field in ("local.published_segmenter", "chat.published_model"):
        return "it changes only how screens and reports name what is in use"
    if section in _sections_of_components() - _sections_in_use(method):
        return f"no component in use reads the section '{section}'"
    if field in _DRAWN | _ASKED and not asks_model:
        return "no model is asked about the map"
    if field == "mapping.block_destination" and not chosen.chooses_blocks:
        return f"--agent {chosen.agent.spec} goes to no blocks"
    if field == "search.reconsider_steps":
        chooses = chosen.reasoner or chosen.agent
        return "" if answers_at_once(chooses.load()) else f"{chooses.spec} is asked only once"
    if (section == "presence" or field == "search.verify_view") and not chosen.presence:
        return "without a model nobody checks the presence of the goal"
    if field in _ABOUT_EROSION and local.pixels == "box":
        return "a box is not eroded"
    if field == "local.keep_thin_masks" and local.erosion_px == 1:
        return "no mask is eroded"
    return ""


def _sections_of_components() -> set[str]:
    return set().union(*(registry.sections for registry in COMPONENTS))


def _sections_in_use(method: Method) -> set[str]:
    choices = method.chosen.by_kind.values()
    used = {choice.entry.section for choice in choices}
    if any("fallback" in asked_by(choice) for choice in choices):
        used.add("geometric")
    return used
