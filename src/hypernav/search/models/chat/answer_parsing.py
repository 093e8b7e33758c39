"""The answer in a model's text: without thinking and wrappings, and one of those allowed.

The laws of unwrapping, in the order in which they are applied until nothing changes:

1. A turn ends at its first end-of-turn token; what a model writes beyond it is no answer.
2. What comes before the last mark that ends thinking is thinking. This covers a chat template that
   begins the thinking in the prompt, so that the text holds only its end. Where thinking begins
   and does not end, there is no answer: the text was cut.
3. Of answers in a container, as ``<answer>…</answer>``, the content is the answer. If there are
   several different ones, there is no answer, unless all are lists of four or more numbers: boxes.
4. A code fence that the text ends with, after words without numbers, and emphasis around the
   whole text are taken off.

A mark between quotes is a mention, not a mark. Unwrapping twice is unwrapping once, and a text
without marks is unchanged, but for white space around it.

Sources of the marks: the reasoning parsers of vLLM and SGLang (``sglang/srt/parser/
reasoning_parser.py``: DeepSeek, Qwen, GLM, Step, Kimi, Seed, MiniMax, Mistral, Gemma 4, Cohere,
Apertus, IFM); OpenAI's harmony format (channels); zai-org/GLM-V, README (``<|begin_of_box|>``);
FlagOpen/RoboBrain2.0, ``inference.py``, and pickxiguapi/Embodied-R1 (``<answer>``); end-of-turn
tokens of the makers' tokenizers.

What is left is one of the allowed answers, a JSON form, or a fault: several servers accept a
constraint and silently ignore it (``transformers serve`` logs a warning and continues, Ollama's
cloud drops JSON schemas), so every answer is checked here.
"""

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import islice
from typing import Any

from pydantic import BaseModel, ValidationError

from hypernav.core.chat import Answer, Fault, Question, Usage

_QUOTES = "\"'`“”‘’«»"
_BEFORE_QUOTES = _QUOTES + " \t\n([{:,=/-—"
"""What stands before a quote that opens; after a word it closes."""
_MOST_LAYERS = 24
_MOST_CHARACTERS = 32_768
_MOST_BOXED, _LONGEST_BOXED = 64, 4_000

CUT_IN_THINKING = (
    "the reply ends within the model's thinking, which used up the tokens: switch thinking off "
    "(--set chat.thinking=off) or raise the limit of this question (its max_tokens)"
)
"""What to tell about a reply that was cut within its thinking."""
SEVERAL_ANSWERS = "the reply holds several different answers"
"""What to tell about a reply with contradicting containers."""

_NAMED = (
    r"think(?:ing)?|thoughts?|reasoning|analysis|reflection|rationale|scratchpad|cot|seed:think"
    r"|plan(?:ning)?|thought_process|mm:think|redacted_reasoning|[a-z]{1,16}_think(?:ing)?"
)
_THINK = re.compile(rf"<(?:{_NAMED}|think:[\w-]{{1,32}})(?:\s[^<>]{{0,80}})?>", re.IGNORECASE)
_THINK_END = re.compile(rf"</(?:{_NAMED}|think:[\w-]{{1,32}})\s*(?:>|\Z)", re.IGNORECASE)
_CHANNEL = r"<\|channel\|>\s*{}\b[^<]{{0,80}}(?:<\|constrain\|>[^<]{{0,40}})?<\|message\|>"

_BEGINS: tuple[tuple[str, re.Pattern[str]], ...] = (
    ("<think>", _THINK),
    ("[THINK]", re.compile(r"\[THINK\]")),
    ("◁think▷", re.compile("◁think▷")),
    ("<|think|>", re.compile(r"<\|think(?:ing)?\|>")),
    ("<unused94>", re.compile(r"<unused94>\s*thought\b")),
    ("<details>", re.compile(r"<details\s[^<>]{0,80}reasoning[^<>]{0,80}>")),
    ("prose", re.compile(r"\AHere (?:is my thought process|are my reasoning steps):")),
    ("<|START_THINKING|>", re.compile(r"<\|START_THINKING\|>|<\|begin_of_thought\|>")),
    ("<|inner_prefix|>", re.compile(r"<\|inner_prefix\|>|<ifm\|think\w{0,8}>")),
    ("channels", re.compile(_CHANNEL.format("(?:analysis|commentary)"))),
    ("channels", re.compile(r"<\|channel>\s*thought\b")),
    # A server that leaves special tokens out writes the channel's name against the first word.
    ("channels", re.compile(r"\A(?:analysis|commentary)(?=[A-Z])")),
)
_ENDS: tuple[tuple[str, re.Pattern[str]], ...] = (
    ("<think>", _THINK_END),
    ("[THINK]", re.compile(r"\[/THINK\]")),
    ("◁think▷", re.compile("◁/think▷")),
    ("<|think|>", re.compile(r"<\|/think(?:ing)?\|>")),
    ("<unused94>", re.compile("<unused95>")),
    ("<details>", re.compile("</details>")),
    ("prose", re.compile(r"\[BEGIN FINAL RESPONSE\]|^Here is my response:", re.MULTILINE)),
    ("<|START_THINKING|>", re.compile(r"<\|END_THINKING\|>|<\|end_of_thought\|>")),
    ("<|inner_prefix|>", re.compile(r"<\|inner_suffix\|>|</ifm\|think\w{0,8}>")),
    ("channels", re.compile(_CHANNEL.format("final"))),
    ("channels", re.compile(r"<channel\|>")),
)
_BARE_BEGIN, _BARE_END = re.compile(r"\A(?:analysis|commentary)"), re.compile("assistantfinal")

_CONTAINERS: tuple[tuple[str, re.Pattern[str], re.Pattern[str]], ...] = tuple(
    (name, re.compile(begin, re.IGNORECASE), re.compile(end, re.IGNORECASE))
    for name, begin, end in (
        ("<answer>", r"<(?:final_?)?answer>", r"</(?:final_?)?answer>"),
        ("<response>", r"<response>|<\|START_(?:RESPONSE|TEXT)\|>",
         r"</response>|<\|END_(?:RESPONSE|TEXT)\|>"),
        ("<|begin_of_solution|>", r"<\|begin_of_solution\|>", r"<\|end_of_solution\|>"),
        ("box tokens", r"<\|begin_of_box\|>", r"<\|end_of_box\|>"),
    )
)  # fmt: skip
_BOXED = re.compile(r"\\(?:boxed|fbox)\s{0,4}\{")
_TEX_TEXT = re.compile(r"\\(?:text|textbf|textit|mathrm|mathbf|mathit)\s*\{([^{}]*)\}")
_NUMBER = re.compile(r"\d+(?:\.\d+)?")
_LETTERS = re.compile(r"[^\W\d_]{2,}")

_TURN_ENDS = re.compile(
    r"<\|(?:im_end|eot_id|eom_id|eot|eos|endoftext|end_of_text|return|call|user|observation|EOT"
    r"|END_OF_TURN_TOKEN|end_of_msg|endofassistant|im_user|eou|end_of_sentence)\|>"
    r"|<\|end\|>(?!\s*<\|(?:start|channel)\|>)"
    r"|</s>|<eos>|<end_of_turn>|<turn\|>|<seed:eos>|<end_of_utterance>|\[EOS\]|<eod>"
    r"|\[\|endofturn\|\]|<｜end▁of▁sentence｜>|\[END FINAL RESPONSE\]"
)
_TURN_BEGINS = re.compile(
    r"\A\s*(?:(?:</s>\s*)?<s>|<bos>|<\|begin_of_text\|>|\[/INST\]"
    r"|<\|(?:im_start|start)\|>\s*assistant|<\|im_assistant\|>\s*assistant\s*<\|im_middle\|>"
    r"|<\|start_header_id\|>\s*assistant\s*<\|end_header_id\|>"
    r"|<\|assistant\|>|<start_of_turn>\s*model|<\|turn>\s*model|<｜Assistant｜>"
    r"|<\|START_OF_TURN_TOKEN\|>|<\|CHATBOT_TOKEN\|>)"
)
_FENCED = re.compile(r"[^\d`]*```(?:[a-zA-Z]+\b)?(?P<inside>[^`]*)(?:```)?")
_EMPHASIS = re.compile(r"(?P<mark>\*{1,3}|_{1,3}|\${1,2})(?P<inside>[^*_$\n]+?)(?P=mark)[.!]?")

_REFUSAL = re.compile(
    r"\s*(?:i['’]?m (?:very )?sorry|sorry\b|i (?:can ?not|can['’]t|am unable|'m unable|won['’]t)\b"
    r"|as an ai\b|unfortunately,? i (?:can ?not|can['’]t))",
    re.IGNORECASE,
)
# "Answer: block 3" says 3, but "I would not go to 3" does not.
_LEAD = re.compile(
    r"^\W{0,40}(?:(?:the|my|final|answer|choice|block|number|is)\b[\s:#*]{0,40})+", re.IGNORECASE
)
_NO_IDIOM = re.compile(
    r"no (?:doubt|question|problem|wonder|idea|clue|way|need|one|comment|response|answer|fewer|less"
    r"|image|picture|photo|information|input)s?\b"
)
_DENIAL = re.compile(
    r"(?<![a-z])(?:not?|non|absent|empty|missing|hidden|without|invisible|rejected|excluded|discarded"
    r"|ignored|avoid|blocked|unreachable|visited|explored|un(?:seen|likely|sure|certain)"
    r"|false|wrong)(?![a-z])|n['’]t\b",
    re.IGNORECASE,
)
_COUNTED = re.compile(r"(?:m|cm|met(?:er|re)s?|blocks|steps|times|%)(?!\w)")
_BULLET = re.compile(r"^(?:[-*•]\s+|[^\w\s\"'`({\[<-]\s+)+")
_CAPITAL = re.compile(r"(?<=[a-z])(?=[A-Z])")
_FIRST_SENTENCE = re.compile(r"[^\W\d_][^.!:\n\[{]*")
_AT_LIMIT = (
    "the reply reached its limit of tokens: if the model thinks, switch thinking off "
    "(--set chat.thinking=off) or raise the limit"
)
_SHORT = 80
LONGEST_ANSWER = 32_768
"""Characters of an answer that are kept: 20 times the longest answer that is asked for."""


@dataclass(frozen=True)
class Unwrapped:
    """A model's final answer.

    Attributes:
        text: The answer; empty if there is none.
        removed: Names of what was taken off, each once, the outermost first.
        problem: Why there is no answer, for people; empty if there is one, or the text is empty.
    """

    text: str
    removed: tuple[str, ...] = ()
    problem: str = ""

    @property
    def is_cut(self) -> bool:
        """Whether the text ends within the model's thinking."""
        return self.problem == CUT_IN_THINKING


def final_answer(text: str) -> str:
    """The final answer in a model's text; empty if there is none."""
    return unwrapped(text).text


def unwrapped(text: str) -> Unwrapped:
    """Take thinking and wrappings off a model's text, whatever it is.

    Args:
        text: Text of the model; of more than 32,768 characters the first ones count.
    """
    text, removed = text[:_MOST_CHARACTERS].strip(), dict[str, None]()
    for _ in range(_MOST_LAYERS):
        step = _outermost(text)
        if step is None:
            return Unwrapped(text, tuple(removed))
        removed |= dict.fromkeys(step.removed)
        if step.problem:
            return Unwrapped("", tuple(removed), step.problem)
        text = step.text.strip()
    return Unwrapped("", tuple(removed), f"the answer is wrapped more than {_MOST_LAYERS} times")


def end_of_thinking(text: str) -> tuple[int, str] | None:
    """Where the last mark that ends thinking ends, and its name; None if there is none."""
    ends = _ENDS if _BARE_BEGIN.match(text) is None else (*_ENDS, ("channels", _BARE_END))
    found = [(match.end(), name) for name, pattern in ends for match in _marks(pattern, text)]
    return max(found, default=None)


def begin_of_thinking(text: str) -> str | None:
    """Name of a mark in the text that begins thinking; None if there is none."""
    begun = (name for name, pattern in _BEGINS if next(_marks(pattern, text), None) is not None)
    return next(begun, None)


def _outermost(text: str) -> Unwrapped | None:
    """The text without its outermost wrapping; None if it has none."""
    for take_off in (_one_turn, _without_thinking, _contained, _boxed, _undressed):
        step = take_off(text)
        if step is not None:
            return step
    return None


def _marks(pattern: re.Pattern[str], text: str) -> Iterator[re.Match[str]]:
    """Where a mark is; between quotes it is only mentioned."""
    for match in pattern.finditer(text):
        before, after = text[: match.start()][-2:], text[match.end() : match.end() + 1]
        is_opened = before[-1:] in _QUOTES and before[:1] in _BEFORE_QUOTES
        if not (before and is_opened and after and after in _QUOTES):
            yield match


def _one_turn(text: str) -> Unwrapped | None:
    begin = _TURN_BEGINS.match(text)
    if begin is not None:
        return Unwrapped(text[begin.end() :], ("turn tokens",))
    end = next(_marks(_TURN_ENDS, text), None)
    return None if end is None else Unwrapped(text[: end.start()], ("turn tokens",))


def _without_thinking(text: str) -> Unwrapped | None:
    found = end_of_thinking(text)
    if found is not None:
        end, name = found
        rest = text[end:]
        problem = "" if rest.strip() else "nothing follows the model's thinking"
        return Unwrapped(rest, (name,), problem)
    begun = begin_of_thinking(text)
    return None if begun is None else Unwrapped("", (begun,), CUT_IN_THINKING)


def _contained(text: str) -> Unwrapped | None:
    for name, begin, end in _CONTAINERS:
        begins, ends = list(_marks(begin, text)), list(_marks(end, text))
        if not begins and not ends:
            continue
        # The template may have begun the container in the prompt; a stop word may end it unseen.
        starts = [match.end() for match in begins] or [0]
        contents = []
        for start, following in zip(starts, [*(m.start() for m in begins[1:]), None], strict=True):
            stop = next((m.start() for m in ends if m.start() >= start), following)
            contents.append(text[start:stop].strip())
        return _agreed(contents, name)
    return None


def _agreed(contents: list[str], name: str) -> Unwrapped:
    """The one content, or all boxes."""
    distinct = list(dict.fromkeys(contents))
    if len(distinct) > 1 and not all(map(_is_boxes, distinct)):
        return Unwrapped("", (name,), SEVERAL_ANSWERS)
    return Unwrapped("\n".join(distinct), (name,))


def _is_boxes(content: str) -> bool:
    return len(_NUMBER.findall(content)) >= 4 and not _LETTERS.search(content)


def _boxed(text: str) -> Unwrapped | None:
    contents = []
    for match in islice(_marks(_BOXED, text), _MOST_BOXED):
        depth = 1
        for at in range(match.end(), min(len(text), match.end() + _LONGEST_BOXED)):
            depth += {"{": 1, "}": -1}.get(text[at], 0)
            if depth == 0:
                contents.append(_TEX_TEXT.sub(r"\1", text[match.end() : at]).strip())
                break
    return _agreed(contents, "\\boxed") if contents else None


def _undressed(text: str) -> Unwrapped | None:
    """The text without a code fence at its end, or emphasis around it."""
    for name, pattern in (("code fence", _FENCED), ("emphasis", _EMPHASIS)):
        match = pattern.fullmatch(text)
        if match is not None:
            return Unwrapped(match["inside"], (name,))
    return None


def parse_answer(
    question: Question,
    text: str,
    *,
    model: str,
    usage: Usage | None = None,
    seconds: float = 0.0,
    lost: Mapping[str, int] | None = None,
    probabilities: Mapping[str, float] | None = None,
    refused: bool = False,
    is_cut: bool = False,
) -> Answer:
    """Parse the text of a model and check it against the question.

    Args:
        question: Question that was asked.
        text: Text of the model.
        model: Name of the model.
        usage: Token usage.
        seconds: Duration of the request.
        lost: Number of failed attempts before this answer, by reason.
        probabilities: Probabilities of the allowed answers.
        refused: Whether the server reports that the model declined.
        is_cut: Whether the text ends because it reached the limit of tokens.
    """
    text = writable(text[:LONGEST_ANSWER])
    final = unwrapped(text)
    said = final.text
    answer = Answer(
        text=text,
        model=model,
        usage=usage or Usage(),
        seconds=seconds,
        lost=lost or {},
        probabilities=probabilities or {},
    )
    if refused:
        return _faulty(answer, Fault.REFUSED, f"declined: {shortened(said) or 'no reason given'}")
    if final.is_cut or (is_cut and question.at_once and _thinks_aloud(said)):
        return _faulty(answer, Fault.CUT, CUT_IN_THINKING)
    if not said:
        return _faulty(answer, Fault.UNPARSABLE, final.problem or "the answer is empty")
    if len(text) >= LONGEST_ANSWER:
        detail = f"the answer has {LONGEST_ANSWER:,} characters or more: '{shortened(said)}'"
        return _faulty(answer, Fault.UNPARSABLE, detail)
    if question.allowed:
        parsed = _parse_allowed(answer, said, question.allowed)
        hint = f"; {_AT_LIMIT}" if is_cut and parsed.fault is not None else ""
        return replace(parsed, detail=parsed.detail + hint)
    if question.form is not None:
        return _parse_form(answer, said, question.form)
    return replace(answer, value=said)


def writable(text: str) -> str:
    """The text without unpaired surrogates, which JSON may contain but no file can store."""
    return text.encode("utf-16", "surrogatepass").decode("utf-16", "replace")


def shortened(text: str, length: int = _SHORT) -> str:
    """Text as one line of limited length, for messages."""
    line = " ".join(writable(text[: 8 * length]).split())  # an answer may be long
    return line if len(line) <= length else line[: length - 1] + "…"


def denies(name: str) -> bool:
    """Whether a label or a key tells what is not there, as "not_visible" and "no bed" do."""
    return _DENIAL.search(_CAPITAL.sub(" ", name[:LONGEST_ANSWER])) is not None


def _thinks_aloud(said: str) -> bool:
    """Whether a text begins with prose, as thinking does whose begin is in the prompt."""
    sentence = _FIRST_SENTENCE.match(said)
    return sentence is not None and (len(sentence[0].split()) > 4 or len(sentence[0]) > 40)


def _faulty(answer: Answer, fault: Fault, detail: str) -> Answer:
    return replace(answer, fault=fault, detail=detail)


def _parse_allowed(answer: Answer, said: str, allowed: tuple[str, ...]) -> Answer:
    by_key = {_key(label): label for label in allowed}
    bare = _single(said)
    if _key(bare) in by_key:
        return replace(answer, value=by_key[_key(bare)])
    words = [_key(word) for word in _LEAD.sub("", bare, count=1).split()]
    mentioned = {by_key[word] for word in words if word in by_key}
    rest = " ".join(words[1:])
    # "Yes, but it is not a bed" and "Block 3 is excluded" take back what they say.
    is_taken_back = words[:1] != ["no"] and denies(rest)
    is_count = bool(words) and words[0].isdigit() and _COUNTED.match(rest)
    if _NO_IDIOM.match(" ".join(words)) or is_taken_back or is_count:
        mentioned.clear()
    if words and words[0] in by_key and len(mentioned) == 1:
        return replace(answer, value=by_key[words[0]])
    if _REFUSAL.match(said):
        return _faulty(answer, Fault.REFUSED, f"declined: {shortened(said)}")
    expected = ", ".join(allowed)
    if len(words) == 1:
        return _faulty(answer, Fault.INVALID, f"'{shortened(bare)}' is none of: {expected}")
    return _faulty(
        answer, Fault.UNPARSABLE, f"'{shortened(bare)}' does not name exactly one of: {expected}"
    )


def _key(text: str) -> str:
    return text.strip(" \t\r\n.,:;!?\"'`*()[]{}#").casefold()


def _single(said: str) -> str:
    """The text without a mark before it, and without the JSON object around a single answer."""
    value = _json_in(said)
    if isinstance(value, dict) and "answer" in value:  # perhaps with its confidence or reason
        value = value["answer"]
    elif isinstance(value, dict) and len(value) == 1:
        ((key, value),) = value.items()
        if denies(key):
            return said
    if isinstance(value, str | int) and not isinstance(value, bool):
        return str(value)
    return _BULLET.sub("", said)


def _json_in(text: str) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return None


def _parse_form(answer: Answer, said: str, form: type[BaseModel]) -> Answer:
    begin, end = said.find("{"), said.rfind("}")
    if begin < 0 or end < begin:
        fault = Fault.REFUSED if _REFUSAL.match(said) else Fault.UNPARSABLE
        return _faulty(answer, fault, f"no JSON object in '{shortened(said)}'")
    try:
        return replace(answer, value=form.model_validate_json(said[begin : end + 1]))
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        broken = first["type"] == "json_invalid"
        where = ".".join(map(str, first["loc"])) or form.__name__
        return _faulty(
            answer,
            Fault.UNPARSABLE if broken else Fault.INVALID,
            f"{where}: {first['msg']} in '{shortened(said)}'",
        )
