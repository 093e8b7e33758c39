"""Examination of a model and its server before a robot relies on them.

Every check asks about something whose answer is known: a plain colour, a rectangle drawn at a known
position, a map of which one room alone leads on, an image that shows a thing and one that doesn't,
a question that a free model would answer at length.
"""

from collections.abc import Generator, Iterator
from typing import Protocol, runtime_checkable

import numpy as np

from hypernav.core.chat import Answer, Question
from hypernav.core.components.protocols import ChatModel
from hypernav.core.errors import ChatError, ConfigError, ModelRejectedError, ModelSetupError
from hypernav.core.geometry.boxes import Box
from hypernav.core.goal import Goal
from hypernav.evaluation.checks.findings import Finding, State
from hypernav.evaluation.checks.known_answers import (
    HEIGHT,
    SHAPE,
    SHAPE_BOX,
    WIDTH,
    drawn_ground,
    drawn_house,
    drawn_shape,
)
from hypernav.models.chat.answer_parsing import shortened
from hypernav.models.chat.server.detection import ServerInfo
from hypernav.models.chat.unwrapping import final_answer
from hypernav.models.chat.vlm_families import VlmFamily, family_named, family_of
from hypernav.perception.explorers.block_explorer import OverviewConfig
from hypernav.perception.explorers.map_question import (
    VlmReasonerConfig,
    chosen_number,
    map_question,
    offered_blocks,
)
from hypernav.perception.local.grounding_format import read_grounding
from hypernav.perception.local.presence import PresenceConfig, presence_question
from hypernav.perception.local.vlm_detector import VlmDetectorConfig, grounding_question

_MATCH = 0.5
_COLOURS: dict[str, tuple[int, int, int]] = {"blue": (30, 60, 220), "green": (40, 160, 60)}
_READINGS = ("pixels", "thousandths", "unit", "gemini")
_MAP_GOAL = Goal("bed")
_RIGHT_BLOCKS = (2, 3)
_NO_WORDS = "let the model answer without thinking first; the server's log may say more"
_WAIT = "look into the server's log; --set chat.timeout_s=… waits longer for an answer"


@runtime_checkable
class _BehindServer(ChatModel, Protocol):
    """A chat model behind a server, which can be asked for itself."""

    @property
    def url(self) -> str: ...

    @property
    def dropped(self) -> tuple[str, ...]: ...

    def server(self) -> ServerInfo: ...


def check_up(
    chat: ChatModel,
    grounding: VlmDetectorConfig,
    overview: OverviewConfig,
    block_choice: VlmReasonerConfig,
    presence: PresenceConfig,
) -> Iterator[Finding]:
    """Examine a model, one finding after the other; stops where going on makes no sense.

    Args:
        chat: Model to examine; best without retries, so that faults show at once.
        grounding: Configuration of the question for boxes.
        overview: Drawing of the map.
        block_choice: Configuration of the map question.
        presence: Configuration of the question whether the goal is there.
    """
    try:
        answers = True
        if isinstance(chat, _BehindServer):
            answers = yield from _check_server(chat)
        if answers and (yield from _check_vision(chat)):
            yield from _check_coordinates(chat, grounding)
            yield from _check_constraints(chat)
            yield from _check_map(chat, overview, block_choice)
            yield from _check_presence(chat, presence)
        elif answers:
            yield from _check_constraints(chat)
    except ChatError as error:
        yield Finding("answers", State.FAULT, str(error), _WAIT)


def _check_server(chat: _BehindServer) -> Generator[Finding, None, bool]:
    """Whether the server can be reached and has the model."""
    try:
        server = chat.server()
    except ChatError as error:
        remedy = "start the server, or correct the URL after openai:"
        yield Finding("server", State.FAULT, str(error), remedy)
        return False
    about = f"{chat.url} answers and speaks the dialect '{server.dialect.name}'"
    if server.list_fault:
        yield Finding("server", State.NOTE, f"{about}, but has no list: {server.list_fault}")
    else:
        yield Finding("server", State.GOOD, about)
    # Some servers list nothing, or list other names than they take: only an answer tells.
    try:
        answer = chat.ask(Question("hello", "Answer with the word: ready", max_tokens=16))
    except (ModelRejectedError, ModelSetupError) as error:
        remedy = "name one of the server's models after #"
        yield Finding("model name", State.FAULT, str(error), remedy)
        return False
    told = f"{server.model} answers"
    if answer.fault is not None:
        yield Finding("model name", State.FAULT, f"{told}, but {answer.detail}", _NO_WORDS)
    elif answer.usage.tokens_in == 0:
        yield Finding("model name", State.NOTE, f"{told}, but its server counts no tokens")
    else:
        yield Finding("model name", State.GOOD, told)
    return True


def _check_vision(chat: ChatModel) -> Generator[Finding, None, bool]:
    """Whether the model takes images and tells one colour from another."""
    wrong = []
    for colour, rgb in _COLOURS.items():
        plain = np.full((224, 224, 3), rgb, dtype=np.uint8)
        text = "What colour is this picture? Answer with one word."
        try:
            answer = chat.ask(Question("colour", text, (plain,), max_tokens=16))
        except (ModelRejectedError, ModelSetupError) as error:
            remedy = "serve a model that takes images (llama.cpp: with --mmproj)"
            yield Finding("images", State.FAULT, f"no vision: {error}", remedy)
            return False
        if answer.fault is not None:
            said = f"whether it sees cannot be told: {answer.detail}"
            yield Finding("images", State.FAULT, said, _NO_WORDS)
            return False
        said = final_answer(answer.text)
        if colour not in said.lower():
            wrong.append(f"{colour} is '{shortened(said, 30)}'")
    if wrong:
        said = f"no vision: asked about plain colours, it says that {', '.join(wrong)}"
        remedy = "serve a model that takes images; some servers drop them silently"
        yield Finding("images", State.FAULT, said, remedy)
        return False
    yield Finding("images", State.GOOD, "it tells blue from green")
    return True


def _check_coordinates(chat: ChatModel, config: VlmDetectorConfig) -> Iterator[Finding]:
    """In which coordinates the model answers, by a shape at a known position."""
    family, unknown = _family(chat, config)
    answer = chat.ask(grounding_question(config, family, drawn_shape(), SHAPE))
    best = max(_READINGS, key=lambda name: _overlap(answer.text, family_named(name)))
    scale = _scale(answer.text)
    if _overlap(answer.text, family) >= _MATCH and not unknown:
        yield Finding("coordinates", State.GOOD, f"boxes are right, read as '{family.name}'")
    elif _overlap(answer.text, family_named(best)) >= _MATCH:
        why = unknown or f"boxes are wrong when read as '{family.name}', and right as '{best}'"
        yield Finding("coordinates", State.FAULT, why, f"--set grounding.family={best}")
    elif scale is not None:
        said = f"boxes are {scale:.2f} times too large: the server resizes images"
        remedy = "raise its limit of pixels (vLLM: --mm-processor-kwargs with max_pixels)"
        yield Finding("coordinates", State.FAULT, said, remedy)
    else:
        said = f"no box is where the shape is, in no coordinates: '{shortened(answer.text, 60)}'"
        remedy = "use a model that was trained on grounding, or another --detector"
        yield Finding("coordinates", State.FAULT, said, remedy)
    yield _timed(answer, "ground")


def _check_constraints(chat: ChatModel) -> Iterator[Finding]:
    """Whether only what is allowed can be answered."""
    text = "Describe in two sentences what a robot is."
    answer = chat.ask(
        Question("constraint", text, allowed=("alpha", "bravo", "charlie"), max_tokens=24)
    )
    rejected = isinstance(chat, _BehindServer) and "constraint" in chat.dropped
    if answer.fault is None and not rejected:
        told = "with" if answer.probabilities else "without"
        said = f"only what is allowed comes back, {told} probabilities"
        yield Finding("constraints", State.GOOD, said)
        return
    how = "rejects" if rejected else "ignores"
    yield Finding(
        "constraints",
        State.FAULT,
        f"the server {how} constraints: allowed were alpha, bravo and charlie, and it said "
        f"'{shortened(answer.text, 40)}'",
        "name its kind with --set chat.dialect=…; answers are checked either way",
    )


def _check_map(
    chat: ChatModel, overview: OverviewConfig, config: VlmReasonerConfig
) -> Iterator[Finding]:
    """Whether the model finds on a map the one room that leads on."""
    # Whatever tells the answer in words is left out: the image is examined.
    config = config.model_copy(
        update={"facts": False, "min_frontier_cells": 0, "max_blocks": None, "max_tokens": 300}
    )
    wrong, answers = [], []
    for right in _RIGHT_BLOCKS:
        house = drawn_house(overview, right)
        question = map_question(config, house, _MAP_GOAL)
        answer = chat.ask(question)
        answers.append(answer)
        numbers = [block.number for block in offered_blocks(config, house, frozenset())]
        if chosen_number(question, answer, numbers) != right:
            wrong.append(f"block {right} leads on, and it says '{shortened(answer.text, 60)}'")
    if wrong:
        yield Finding(
            "maps",
            State.FAULT,
            f"it can't read maps: of a house with one way out, {'; '.join(wrong)}",
            "use a larger model, or let our own rule choose blocks: --reasoner geometric",
        )
    else:
        yield Finding("maps", State.GOOD, "it finds the one room that leads on")
    yield _timed(answers[-1], "choose block")


def _check_presence(chat: ChatModel, config: PresenceConfig) -> Iterator[Finding]:
    """Whether the model tells an image that shows a thing from one that doesn't."""
    wrong, answers = [], []
    for image, right in ((drawn_shape(), "yes"), (drawn_ground(), "no")):
        answer = chat.ask(presence_question(config, image, SHAPE))
        answers.append(answer)
        if answer.fault is not None or answer.value != right:
            shown = "an image with" if right == "yes" else "an empty image without"
            wrong.append(f"of {shown} the {SHAPE.text} it says '{shortened(answer.text, 40)}'")
    if wrong:
        yield Finding(
            "presence",
            State.FAULT,
            f"asked whether it sees a {SHAPE.text}, it is wrong: {'; '.join(wrong)}",
            "use a larger model, or search without the check: --set presence.enabled=false",
        )
    else:
        yield Finding("presence", State.GOOD, "it tells what is there from what isn't")
    yield _timed(answers[-1], "verify")


def _timed(answer: Answer, kind: str) -> Finding:
    usage = answer.usage
    said = f"{answer.seconds:.2f} s, {usage.tokens_in} tokens in, {usage.tokens_out} out"
    return Finding(f"question '{kind}'", State.GOOD, said)


def _family(chat: ChatModel, config: VlmDetectorConfig) -> tuple[VlmFamily, str]:
    """The configured family, and the reason why it is not known, if so."""
    if config.family != "auto":
        return family_named(config.family), ""
    name = chat.identify()
    try:
        return family_of(name), ""
    except ConfigError:
        return family_named("pixels"), f"the name '{name}' does not tell in which coordinates"


def _overlap(text: str, family: VlmFamily) -> float:
    """Overlap of the best box, read as this family's, with the shape, 0 to 1."""
    boxes = read_grounding(text, family, WIDTH, HEIGHT).boxes
    return max((one.box.iou(SHAPE_BOX) for one in boxes), default=0.0)


def _scale(text: str) -> float | None:
    """The one factor by which the answer differs from the shape in pixels, if there is one."""
    huge = VlmFamily("pixels", "pixels")
    for one in read_grounding(text, huge, 20 * WIDTH, 20 * HEIGHT).boxes:
        factor = (one.box.x_max - one.box.x_min) / (SHAPE_BOX.x_max - SHAPE_BOX.x_min)
        edges = (SHAPE_BOX.x_min, SHAPE_BOX.y_min, SHAPE_BOX.x_max, SHAPE_BOX.y_max)
        if one.box.iou(Box(*(factor * edge for edge in edges))) >= _MATCH:
            return factor
    return None
