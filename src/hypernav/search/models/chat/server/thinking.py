"""Models that think before they answer: how it is switched off, noticed, and given room.

Sources, all of them the servers' own pages:

- vLLM, SGLang, llama.cpp: ``chat_template_kwargs: {"enable_thinking": false}`` (Qwen3 and later,
  GLM, Gemma 4; DeepSeek and Granite call it ``thinking``); models whose template has no such
  switch take ``reasoning_effort`` (gpt-oss). docs.vllm.ai/en/latest/features/reasoning_outputs,
  docs.sglang.io/docs/advanced_features/separate_reasoning, llama.cpp tools/server/README.md, which
  has ``thinking_budget_tokens`` besides.
- Ollama: ``reasoning_effort: "none"`` or ``reasoning: {"effort": "none"}`` on the OpenAI route;
  ``think`` belongs to its own route. docs.ollama.com/api/openai-compatibility
- OpenAI, Gemini's compatible endpoint, LM Studio, LiteLLM: ``reasoning_effort``, of which models
  take "none", "minimal" or only "low" and above. ai.google.dev/gemini-api/docs/openai
- OpenRouter: ``reasoning: {"effort": …}``. openrouter.ai/docs/use-cases/reasoning-tokens
- DeepSeek, Z.ai, Kimi, Anthropic: ``thinking: {"type": "disabled"}``; DashScope:
  ``enable_thinking: false``.

The thoughts come back as ``reasoning`` (vLLM, OpenRouter, Ollama) or ``reasoning_content`` (SGLang,
llama.cpp, DeepSeek, vLLM before 0.12), in tags within the answer, or not at all, so that only the
count of tokens shows them. Where a chat template has written the opening tag already, an answer
that was cut looks like any other; so the first one that was cut is asked for once more, at length.
"""

import re
import zlib
from dataclasses import dataclass, replace
from typing import Any, Literal

from hypernav.search.models.chat.answer_parsing import (
    LONGEST_ANSWER,
    begin_of_thinking,
    end_of_thinking,
    final_answer,
)
from hypernav.search.models.chat.config import DialectName
from hypernav.search.models.chat.message_parts import read_content, read_reasoning, thinking_tokens

ROOMS = (0, 1024, 4096, 16384)
"""Tokens for thinking that a question may get besides those for its answer, step by step."""

PROBES = ROOMS[1:3]
"""Rooms with which the first cut answer is asked for again."""

ENDLESS = (
    "the model's thinking took all of {room:,} tokens without an answer; try --set "
    "chat.thinking=off or low, a larger context, or a model that does not think"
)
# The last three are Anthropic's, Mistral's and those of OpenAI's newer interface.
_CUT = {"length", "max_tokens", "model_length", "max_output_tokens"}
_MOST_KEPT = 2000
_LEAST_NEWS = 0.15
"""Share of its size to which a text that says something can't be compressed; prose has 0.4."""
_EMPTY = re.compile(r"<think(?:ing)?>\s*</think(?:ing)?>")
_MARKS = re.compile(r"[<>\[\]{}|\\◁▷]")

_TEMPLATE = {"chat_template_kwargs": {"enable_thinking": False, "thinking": False}}
_NONE, _LOW = {"reasoning_effort": "none"}, {"reasoning_effort": "low"}
_REASONING = {"reasoning": {"effort": "none"}}
_OFF: dict[str, tuple[dict[str, Any], ...]] = {
    **dict.fromkeys(("vllm", "vllm-guided", "sglang"), (_TEMPLATE, _NONE, _LOW)),
    "llamacpp": (_TEMPLATE, {"thinking_budget_tokens": 0}, _NONE, _LOW),
    "ollama": (_NONE, _REASONING, _LOW),
}
_OFF_ELSEWHERE = (
    _NONE,
    _REASONING,
    {"thinking": {"type": "disabled"}},
    {"enable_thinking": False},
    _TEMPLATE,
    _LOW,
)


def switches(
    level: Literal["auto", "off", "low"], dialect: DialectName
) -> tuple[dict[str, Any], ...]:
    """Fields that ask a model to think less, one set after the other until one of them helps."""
    match level:
        case "auto":
            return ({},)
        case "off":
            return _OFF.get(dialect, _OFF_ELSEWHERE)
        case "low" if dialect == "llamacpp":  # it reads the field only through its template
            return ({**_LOW, "chat_template_kwargs": _LOW},)
        case "low":
            return (_LOW,)


@dataclass(frozen=True)
class Written:
    """What a model wrote, taken apart as far as the server tells.

    Attributes:
        text: The answer, with tags around thoughts where an answer is all thought.
        has_thoughts: Whether it thought, as far as the reply shows.
        has_closed_only: Whether the answer closes thoughts that it doesn't open.
        is_cut: Whether it ended for want of tokens.
        is_thought_only: Whether there is nothing but thoughts.
    """

    text: str
    has_thoughts: bool
    has_closed_only: bool
    is_cut: bool
    is_thought_only: bool


def read_written(choice: dict[str, Any], usage: object, *, is_prefilled: bool) -> Written:
    """Take a choice of a reply apart.

    Args:
        choice: The choice; its message is an object.
        usage: Usage of tokens that came with it.
        is_prefilled: Whether the chat template opens the thoughts, so that none is opened here.
    """
    message = choice["message"]
    content, reasoning = read_content(message.get("content")), read_reasoning(message)
    is_cut = str(choice.get("finish_reason")).casefold() in _CUT
    content = _with_short_thoughts(content)
    told = _EMPTY.sub("", content[:LONGEST_ANSWER])
    is_opened = begin_of_thinking(told) is not None
    is_closed = end_of_thinking(told) is not None
    has_closed_only = is_closed and not is_opened
    if not is_opened and ("</think>" in content if is_closed else is_prefilled and is_cut):
        content, is_opened = f"<think>{content}", True  # as the chat template did
    has_thoughts = bool(reasoning) or is_opened or is_closed or thinking_tokens(usage) > 0
    is_empty = not final_answer(content)
    if is_empty and not content.strip() and reasoning:
        # Told in the one way that every reader of answers knows; no mark or box of it is left.
        kept = _MARKS.sub(" ", reasoning[:_MOST_KEPT])
        content = f"<think>{kept}" if is_cut else f"<think>{kept}</think>"
    return Written(
        text=content,
        has_thoughts=has_thoughts,
        has_closed_only=has_closed_only,
        is_cut=is_cut,
        is_thought_only=is_empty and (has_thoughts or is_cut),
    )


def babbles(text: str) -> bool:
    """Whether a long text only repeats itself, as models do that have lost the thread."""
    written = text.encode()
    return len(zlib.compress(written)) < _LEAST_NEWS * len(written)


def _with_short_thoughts(content: str) -> str:
    """The content, so that readers of limited length reach the answer after long thoughts."""
    closed = end_of_thinking(content) if len(content) >= LONGEST_ANSWER else None
    if closed is None:
        return content
    return f"<think>{_MARKS.sub(' ', content[:_MOST_KEPT])}</think>{content[closed[0] :]}"


@dataclass(frozen=True)
class Thinking:
    """What is known of a model's thinking.

    Attributes:
        level: What was asked for.
        switch: Which of the `switches` is sent.
        room: Tokens that every question gets besides those for its answer.
        is_seen: Whether it thinks with that switch, as far as its replies show.
        is_prefilled: Whether its chat template opens the thoughts.
        is_probed: Whether a cut answer was asked for at length.
        is_endless: Whether the largest room wasn't enough for a question.
    """

    level: Literal["auto", "off", "low"] = "auto"
    switch: int = 0
    room: int = 0
    is_seen: bool = False
    is_prefilled: bool = False
    is_probed: bool = False
    is_endless: bool = False

    def asks_like(self, other: "Thinking") -> bool:
        """Whether a question is sent in the same way."""
        return (self.switch, self.room) == (other.switch, other.room)

    def merged(self, other: "Thinking") -> "Thinking":
        """What is known together with what another thread has found out meanwhile."""
        first, later = sorted((self, other), key=lambda one: one.switch)
        return replace(
            later,
            room=max(first.room, later.room),
            is_seen=later.is_seen or (first.is_seen and first.switch == later.switch),
            is_prefilled=first.is_prefilled or later.is_prefilled,
            is_probed=first.is_probed or later.is_probed,
            is_endless=first.is_endless or later.is_endless,
        )

    def after(self, written: Written, last_switch: int) -> "Thinking":
        """What is known after a reply; the question is asked again where switch or room differ."""
        known = replace(
            self,
            is_seen=self.is_seen or written.has_thoughts,
            is_prefilled=self.is_prefilled or written.has_closed_only,
        )
        is_cut_in_thought = written.is_cut and written.is_thought_only
        if self.level == "off" and self.switch < last_switch:
            if written.has_thoughts or is_cut_in_thought:
                return replace(known, switch=self.switch + 1, is_seen=False)
        elif is_cut_in_thought:
            larger = [room for room in ROOMS if room > self.room]
            return replace(known, room=larger[0]) if larger else replace(known, is_endless=True)
        return known
