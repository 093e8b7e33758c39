"""Examination of a model and its server before a robot relies on them.

Every check asks about something whose answer is known: a plain colour, a rectangle drawn at a known
position, a map of which one room alone leads on, an image that shows a thing and one that doesn't,
a question that a free model would answer at length.
"""

from collections.abc import Callable, Collection, Generator, Iterator
from dataclasses import dataclass
from typing import Literal, Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float64

from hypernav.core.chat import Answer, Image, Question
from hypernav.core.components.protocols import ChatModel
from hypernav.core.errors import ChatError, ConfigError, ModelRejectedError, ModelSetupError
from hypernav.core.exploring.overview import Block, Overview
from hypernav.core.geometry.boxes import Box
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.lab.evaluation.checks.findings import Finding, State
from hypernav.search.drawing.question_map import draw_question_map
from hypernav.search.models.chat.answer_parsing import final_answer, shortened
from hypernav.search.models.chat.server.dialects import ServerInfo
from hypernav.search.models.chat.server.refusals import CONSTRAINTS
from hypernav.search.models.chat.server.thinking import ENDLESS, Thinking
from hypernav.search.models.chat.vlm_families import VlmFamily, family_named, family_of
from hypernav.search.perception.config import (
    OverviewConfig,
    PresenceConfig,
    VlmDetectorConfig,
    VlmReasonerConfig,
)
from hypernav.search.perception.explorers.block_explorer import question_style
from hypernav.search.perception.explorers.map_question import (
    chosen_number,
    map_question,
    offered_blocks,
)
from hypernav.search.perception.local.grounding_format import read_grounding
from hypernav.search.perception.local.vlm_detector import family_as_seen, grounding_question
from hypernav.search.perception.local.yes_no_checks import presence_question

SHAPE = Goal("red rectangle")
SHAPE_BOX = Box(380.0, 90.0, 560.0, 330.0)
WIDTH, HEIGHT = 640, 480
_ROOM_M, _CELL_M = 4.0, 0.05
_ROOMS: tuple[tuple[int, int], ...] = ((0, 1), (1, 1), (0, 0), (1, 0))
"""Column and row of the rooms, in the order of their numbers."""


def drawn_shape() -> Image:
    """A red rectangle at a known position on a plain, light ground."""
    image = drawn_ground()
    x_min, y_min, x_max, y_max = SHAPE_BOX.pixels()
    image[y_min:y_max, x_min:x_max] = (215, 30, 30)
    return image


def drawn_ground() -> Image:
    """The ground alone."""
    return np.full((HEIGHT, WIDTH, 3), 225, dtype=np.uint8)


@dataclass(frozen=True, eq=False, kw_only=True)
class _House(Overview):
    grid: OccupancyGrid
    frontier: Float64[np.ndarray, "n 2"]
    config: OverviewConfig

    def draw(self, shown: Collection[int], hatched: Collection[int]) -> Image:
        return draw_question_map(
            self.grid,
            [block for block in self.blocks if block.number in {*shown, *hatched}],
            self.robot,
            self.trajectory,
            question_style(self.config),
            size=self.config.image_px,
            excluded=hatched,
            frontier=self.frontier,
        )


def drawn_house(config: OverviewConfig, right: int) -> Overview:
    """A house of four rooms that was walked through, and opens to the unknown in one alone.

    Args:
        config: Drawing of the map.
        right: Number of the room that leads on, 1 to 4 from the upper left to the lower right.
    """
    side, half = round(2 * _ROOM_M / _CELL_M), round(_ROOM_M / _CELL_M)
    margin = half // 4
    cells = np.full((side + 2 * margin,) * 2, Cell.UNKNOWN, dtype=np.uint8)
    house = cells[margin:-margin, margin:-margin]
    house[:] = Cell.FREE
    house[[0, 1, -2, -1], :] = house[:, [0, 1, -2, -1]] = Cell.OCCUPIED
    column, row = _ROOMS[right - 1]
    outer = slice(0, 2) if column == 0 else slice(side - 2, side)
    opening = slice(row * half + half // 5, row * half + 4 * half // 5)
    house[opening, outer] = Cell.FREE
    corner = -margin * _CELL_M
    grid = OccupancyGrid(cells, _CELL_M, (corner, corner))
    edge_x = 0.5 * _CELL_M if column == 0 else 2 * _ROOM_M - 0.5 * _CELL_M
    edge_y = (np.arange(opening.start, opening.stop) + 0.5) * _CELL_M
    frontier = np.stack([np.full(edge_y.size, edge_x), edge_y], axis=1)
    blocks = tuple(
        Block(
            number=number,
            x_min=x * _ROOM_M,
            y_min=y * _ROOM_M,
            size_m=_ROOM_M,
            free_cells=half * half,
            frontier_cells=len(frontier) if number == right else 0,
            destination=((x + 0.5) * _ROOM_M, (y + 0.5) * _ROOM_M),
            travel_m=_ROOM_M,
        )
        for number, (x, y) in enumerate(_ROOMS, start=1)
    )
    robot = Pose2(_ROOM_M, 0.9 * _ROOM_M, 0.5 * np.pi)
    walked = [block.destination for block in blocks if block.number != right]
    return _House(
        blocks,
        robot,
        legend=question_style(config).legend,
        trajectory=[*walked, robot.xy],
        grid=grid,
        frontier=frontier,
        config=config,
    )


_MATCH = 0.5
_COLOURS: dict[str, tuple[int, int, int]] = {"blue": (30, 60, 220), "green": (40, 160, 60)}
_READINGS = ("pixels", "thousandths", "unit", "gemini", "molmo")
_MAP_GOAL = Goal("bed")
_RIGHT_BLOCKS = (2, 3)
_HELLO = Question("hello", "Answer with the word: ready", max_tokens=16)
_NO_WORDS = "look into the server's log for what became of the answer"
_ALL_REASONING = (
    "the server takes the whole answer for reasoning: start it without its reasoning parser, or "
    "with the one of this model"
)
_WAIT = "look into the server's log; --set chat.timeout_s=… waits longer for an answer"
_REFUSED = "what the server says tells; --set chat.extra_body='{…}' sends fields of your own"
_NO_SUCH_MODEL = "name one of the server's models after #"


@runtime_checkable
class _BehindServer(ChatModel, Protocol):
    """A chat model behind a server, which can be asked for itself."""

    @property
    def url(self) -> str: ...

    @property
    def dropped(self) -> tuple[str, ...]: ...

    @property
    def thinking(self) -> Thinking: ...

    def server(self) -> ServerInfo: ...

    def with_thinking(self, level: Literal["auto", "off", "low"]) -> "_BehindServer": ...


def check_up(
    chat: ChatModel,
    grounding: VlmDetectorConfig,
    overview: OverviewConfig,
    block_choice: VlmReasonerConfig,
    presence: PresenceConfig,
    pace: Callable[[float], str],
) -> Iterator[Finding]:
    """Examine a model, one finding after the other; stops where going on makes no sense.

    Args:
        chat: Model to examine; best without retries, so that faults show at once.
        grounding: Configuration of the question for boxes.
        overview: Drawing of the map.
        block_choice: Configuration of the map question.
        presence: Configuration of the question whether the goal is there.
        pace: What the seconds of an answer about an image mean for a search, in words.
    """
    seconds: list[float] = []
    try:
        model = chat
        if isinstance(chat, _BehindServer):
            model = yield from _check_server(chat)
        if model is None:
            return
        sees = yield from _check_vision(model, seconds)
        if sees:
            yield from _check_coordinates(model, grounding, seconds)
        yield from _check_constraints(model)
        if sees:
            yield from _check_map(model, overview, block_choice)
            yield from _check_presence(model, presence)
        if seconds:
            yield Finding("pace", State.GOOD, pace(seconds[-1]))
    except ChatError as error:
        yield Finding("answers", State.FAULT, str(error), error.remedy or _WAIT)


def _check_server(chat: _BehindServer) -> Generator[Finding, None, _BehindServer | None]:
    """Whether the server can be reached and has the model; what to go on with, if so."""
    try:
        server = chat.server()
    except ChatError as error:
        remedy = error.remedy or "start the server, or correct the URL after openai:"
        yield Finding("server", State.FAULT, str(error), remedy)
        return None
    about = f"{chat.url} answers and speaks the dialect '{server.dialect.name}'"
    if server.list_fault:
        yield Finding("server", State.NOTE, f"{about}, but has no list: {server.list_fault}")
    else:
        yield Finding("server", State.GOOD, about)
    # Some servers list nothing, or list other names than they take: only an answer tells.
    try:
        answer = chat.ask(_HELLO)
    except (ModelRejectedError, ModelSetupError) as error:
        default = _REFUSED if isinstance(error, ModelRejectedError) else _NO_SUCH_MODEL
        yield Finding("model name", State.FAULT, str(error), error.remedy or default)
        return None
    told = f"{server.model} answers"
    if answer.fault is not None:
        said = f"{told}, but {answer.detail}"
        yield Finding("model name", State.FAULT, said, _remedy_without_words(chat))
    elif not server.is_listed:
        said = f"{told}, but the server lists other names alone: {', '.join(server.models[:5])}"
        yield Finding("model name", State.NOTE, said)
    elif answer.usage.tokens_in == 0:
        yield Finding("model name", State.NOTE, f"{told}, but its server counts no tokens")
    else:
        yield Finding("model name", State.GOOD, told)
    if chat.dropped:
        left_out = ", ".join(chat.dropped)
        yield Finding("fields", State.NOTE, f"the server refuses {left_out}; they are left out")
    return (yield from _check_thinking(chat, answer))


def _check_thinking(chat: _BehindServer, answer: Answer) -> Generator[Finding, None, _BehindServer]:
    """Whether the model thinks before it answers, and what stops it; what to go on with."""
    known = chat.thinking
    if not known.is_seen:
        if known.level != "auto":
            yield Finding("thinking", State.GOOD, "its replies show no thoughts")
        return chat
    told = f"it thinks before it answers, {answer.usage.tokens_out} tokens for one word"
    if known.level == "auto":
        quiet = chat.with_thinking("off")
        if _answers_without_thinking(quiet):
            told += "; with chat.thinking=off it answers at once"
            yield Finding("thinking", State.NOTE, told, setting="chat.thinking=off")
            return quiet
    if known.level != "low":
        told += ", also when told not to"
    if known.is_endless:
        yield Finding("thinking", State.FAULT, told, ENDLESS.format(room=known.room))
    else:
        told += f"; each answer gets {known.room:,} tokens more for it"
        yield Finding("thinking", State.NOTE, told)
    return chat


def _answers_without_thinking(quiet: _BehindServer) -> bool:
    try:
        return quiet.ask(_HELLO).fault is None and not quiet.thinking.is_seen
    except ChatError:
        return False


def _remedy_without_words(chat: ChatModel) -> str:
    """What to change where an answer holds no words."""
    if not isinstance(chat, _BehindServer) or not chat.thinking.is_seen:
        return _NO_WORDS
    if chat.thinking.is_endless:
        return ENDLESS.format(room=chat.thinking.room)
    return _ALL_REASONING


def _check_vision(chat: ChatModel, seconds: list[float]) -> Generator[Finding, None, bool]:
    """Whether the model takes images and tells one colour from another."""
    wrong = []
    for colour, rgb in _COLOURS.items():
        plain = np.full((224, 224, 3), rgb, dtype=np.uint8)
        text = "What colour is this picture? Answer with one word."
        try:
            answer = chat.ask(Question("colour", text, (plain,), max_tokens=16))
        except (ModelRejectedError, ModelSetupError) as error:
            remedy = "serve a model that takes images (llama.cpp: with --mmproj)"
            yield Finding("images", State.FAULT, f"no vision: {error}", error.remedy or remedy)
            return False
        seconds.append(answer.seconds)
        if answer.fault is not None:
            said = f"whether it sees cannot be told: {answer.detail}"
            yield Finding("images", State.FAULT, said, _remedy_without_words(chat))
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


def grounding_answer(chat: ChatModel, config: VlmDetectorConfig) -> Answer:
    """The answer where the drawn shape is, the usual question of a search."""
    return chat.ask(grounding_question(config, _family(chat, config)[0], drawn_shape(), SHAPE))


def _check_coordinates(
    chat: ChatModel, config: VlmDetectorConfig, seconds: list[float]
) -> Iterator[Finding]:
    """In which coordinates the model answers, by a shape at a known position."""
    family, unknown = _family(chat, config)
    question = grounding_question(config, family, drawn_shape(), SHAPE)
    answer = chat.ask(question)
    seconds.append(answer.seconds)
    seen = family_as_seen(family, question, answer, chat.ask)
    if seen is not family:
        family = seen
        said = f"the server enlarges images, to at least {seen.least_tokens} tokens"
        yield Finding("images", State.NOTE, f"{said}; they are sent as large as that")
    best = max(_READINGS, key=lambda name: _overlap(answer.text, family_named(name)))
    scale = _scale(answer.text)
    if _overlap(answer.text, family) >= _MATCH and not unknown:
        yield Finding("coordinates", State.GOOD, f"they are right, read as '{family.name}'")
    elif _overlap(answer.text, family_named(best)) >= _MATCH:
        why = unknown or f"they are wrong when read as '{family.name}', and right as '{best}'"
        setting = f"grounding.family={best}"
        yield Finding("coordinates", State.FAULT, why, f"--set {setting}", setting)
    elif scale is not None:
        said = f"boxes are {scale:.2f} times too large: the server resizes images"
        remedy = "raise its limit of pixels (vLLM: --mm-processor-kwargs with max_pixels)"
        yield Finding("coordinates", State.FAULT, said, remedy)
    else:
        said = f"no box or point is on the shape, in no coordinates: '{shortened(answer.text, 60)}'"
        remedy = "use a model that was trained on grounding, or another --detector"
        yield Finding("coordinates", State.FAULT, said, remedy)
    yield _timed(answer, "ground")


def _check_constraints(chat: ChatModel) -> Iterator[Finding]:
    """Whether only what is allowed can be answered."""
    text = "Describe in two sentences what a robot is."
    answer = chat.ask(
        Question("constraint", text, allowed=("alpha", "bravo", "charlie"), max_tokens=24)
    )
    rejected = isinstance(chat, _BehindServer) and bool(set(chat.dropped) & set(CONSTRAINTS))
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
    """Overlap of the best box of this family with the shape, 0 to 1; that of a point on it is 1."""
    found = read_grounding(text, family, WIDTH, HEIGHT)
    overlaps = [one.box.iou(SHAPE_BOX) for one in found.boxes]
    overlaps += [
        float(
            SHAPE_BOX.x_min < one.x < SHAPE_BOX.x_max and SHAPE_BOX.y_min < one.y < SHAPE_BOX.y_max
        )
        for one in found.points
    ]
    return max(overlaps, default=0.0)


def _scale(text: str) -> float | None:
    """The one factor by which the answer differs from the shape in pixels, if there is one."""
    huge = VlmFamily("pixels", "pixels")
    for one in read_grounding(text, huge, 20 * WIDTH, 20 * HEIGHT).boxes:
        factor = (one.box.x_max - one.box.x_min) / (SHAPE_BOX.x_max - SHAPE_BOX.x_min)
        edges = (SHAPE_BOX.x_min, SHAPE_BOX.y_min, SHAPE_BOX.x_max, SHAPE_BOX.y_max)
        if one.box.iou(Box(*(factor * edge for edge in edges))) >= _MATCH:
            return factor
    return None
