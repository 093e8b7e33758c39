"""Recording of a chat model's exchanges, their replay without it, and a restart after a crash.

A recording is a JSON-lines file: a header, then one exchange per line in the order of the answers.
Images are named by the hash of their pixels, so a recording stays small and a replay notices when
an image differs in a single pixel.
"""

import hashlib
import json
import threading
from collections import defaultdict, deque
from contextlib import closing
from difflib import SequenceMatcher
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from hypernav.core.chat import Answer, Fault, Question, Usage
from hypernav.core.components.protocols import ChatModel
from hypernav.core.errors import ModelUnavailableError, OutputError, RecordingError
from hypernav.io.foreign_folder import read_own
from hypernav.io.parsing import check_json_size
from hypernav.io.reading import Allowance, read_file
from hypernav.io.writing import AppendOnlyFile
from hypernav.search.models.chat.answer_parsing import parse_answer, shortened
from hypernav.search.models.chat.message_parts import content_hash

_MOST_BYTES = 500_000_000
_MOST_TOKENS = 1_000_000_000


class _Line(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class _Header(_Line):
    format: Literal["hypernav-recording"] = "hypernav-recording"
    version: Literal[1] = 1
    model: str


class _RecordedQuestion(_Line):
    kind: str
    text: str
    images: list[str]
    allowed: list[str]
    form: dict[str, Any] | None
    max_tokens: int

    @staticmethod
    def of(question: Question) -> "_RecordedQuestion":
        return _RecordedQuestion(
            kind=question.kind,
            text=question.text,
            images=[content_hash(image) for image in question.images],
            allowed=list(question.allowed),
            form=None if question.form is None else question.form.model_json_schema(),
            max_tokens=question.max_tokens,
        )

    @property
    def key(self) -> str:
        return hashlib.sha256(
            json.dumps(self.model_dump(), sort_keys=True).encode("utf-8")
        ).hexdigest()


class _RecordedAnswer(_Line):
    text: str = ""
    model: str
    tokens_in: int = Field(default=0, ge=0, le=_MOST_TOKENS)
    tokens_out: int = Field(default=0, ge=0, le=_MOST_TOKENS)
    seconds: float = Field(default=0.0, ge=0.0)
    lost: dict[str, Annotated[int, Field(ge=0)]] = Field(default_factory=dict)
    probabilities: dict[str, Annotated[float, Field(ge=0.0)]] = Field(default_factory=dict)
    refused: bool = False
    is_cut: bool = False
    unavailable: str = ""


class _Exchange(_Line):
    question: _RecordedQuestion
    answer: _RecordedAnswer


class RecordingChat:
    """A chat model whose exchanges are written to a file immediately. Thread-safe."""

    def __init__(self, model: ChatModel, path: Path | str, *, append: bool = False) -> None:
        """Begin a recording.

        Args:
            model: Model that is asked.
            path: File of the recording.
            append: Whether to continue an existing file.

        Raises:
            RecordingError: The file exists already, or cannot be written.
        """
        self._model = model
        self.path = Path(path)
        self._lock = threading.Lock()
        self._name = ""
        try:
            if self.path.exists() and not append:
                raise RecordingError(
                    f"{self.path} exists already; delete it or record to another file"
                )
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self._file = AppendOnlyFile(self.path)
        except OSError as error:
            raise RecordingError(f"cannot record to {self.path}: {error.strerror}") from error

    def identify(self) -> str:
        """The model's name."""
        self._name = self._model.identify()
        return self._name

    def ask(self, question: Question) -> Answer:
        """Ask the model, and record question and answer."""
        try:
            answer = self._model.ask(question)
        except ModelUnavailableError as error:
            self._write(question, _RecordedAnswer(model=self._name, unavailable=str(error)))
            raise
        recorded = _RecordedAnswer(
            text=answer.text,
            model=answer.model,
            tokens_in=answer.usage.tokens_in,
            tokens_out=answer.usage.tokens_out,
            seconds=answer.seconds,
            lost=dict(sorted(answer.lost.items())),
            probabilities=dict(answer.probabilities),
            refused=answer.fault is Fault.REFUSED,
            is_cut=answer.fault is Fault.CUT,
        )
        self._write(question, recorded)
        return answer

    def close(self) -> None:
        """Close the file; the recorded exchanges are on disk already."""
        with self._lock:
            self._file.close()

    def _write(self, question: Question, answer: _RecordedAnswer) -> None:
        line = _Exchange(question=_RecordedQuestion.of(question), answer=answer).model_dump_json()
        with self._lock:
            try:
                if self._file.size == 0:
                    line = _Header(model=answer.model).model_dump_json() + "\n" + line
                self._file.append(line.encode() + b"\n")
            except OSError as error:
                raise OutputError(f"{self.path} cannot be written ({error.strerror})") from error


class ReplayChat:
    """Answers from a recording. A question asked several times gets its answers in order."""

    def __init__(self, path: Path | str) -> None:
        """Read a recording.

        Raises:
            RecordingError: The file is missing or broken; the message names the line.
        """
        self.path = Path(path)
        self._header, exchanges = _read(self.path)
        self._lock = threading.Lock()
        self._questions = [exchange.question for exchange in exchanges]
        self._answers: dict[str, deque[_RecordedAnswer]] = defaultdict(deque)
        for exchange in exchanges:
            self._answers[exchange.question.key].append(exchange.answer)

    def identify(self) -> str:
        """The recorded model's name."""
        return self._header.model

    def ask(self, question: Question) -> Answer:
        """The recorded answer.

        Raises:
            RecordingError: The question is not in the recording, or was asked fewer times.
            ModelUnavailableError: The recorded model was unavailable.
        """
        answer = self.take(question)
        if answer is None:
            raise RecordingError(self._missing(_RecordedQuestion.of(question)))
        return answer

    def take(self, question: Question) -> Answer | None:
        """The recorded answer, or None if the recording holds no further one.

        Raises:
            ModelUnavailableError: The recorded model was unavailable.
        """
        key = _RecordedQuestion.of(question).key
        with self._lock:
            answers = self._answers.get(key)
            if not answers:
                return None
            answer = answers.popleft()
        if answer.unavailable:
            raise ModelUnavailableError(answer.unavailable)
        return parse_answer(
            question,
            answer.text,
            model=answer.model,
            usage=Usage(answer.tokens_in, answer.tokens_out),
            seconds=answer.seconds,
            lost=answer.lost,
            probabilities=answer.probabilities,
            refused=answer.refused,
            is_cut=answer.is_cut,
        )

    def _missing(self, asked: _RecordedQuestion) -> str:
        begin = f"{self.path} holds no answer to this '{asked.kind}' question"
        if asked.key in self._answers:
            times = sum(asked.key == question.key for question in self._questions)
            return f"{begin} any more: it was asked {times} times in the recording"
        if not self._questions:
            return f"{begin}: the recording is empty"
        nearest = max(self._questions, key=lambda question: _similarity(asked, question))
        differences = [
            name
            for name in ("kind", "text", "images", "allowed", "form", "max_tokens")
            if getattr(asked, name) != getattr(nearest, name)
        ]
        return (
            f"{begin}; the nearest differs in {', '.join(differences)}. "
            f"Asked: '{shortened(asked.text, 200)}' {_images(asked)}. "
            f"Nearest: '{shortened(nearest.text, 200)}' {_images(nearest)}"
        )


def _read(path: Path) -> tuple[_Header, list[_Exchange]]:
    try:
        # Not `splitlines`: an answer may contain other line separators, which JSON does not escape.
        text = read_file(path, most=_MOST_BYTES)
        check_json_size(text, Allowance())
        lines = text.decode("utf-8-sig").removesuffix("\n").split("\n")
    except OSError as error:
        raise RecordingError(f"cannot read the recording {path}: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise RecordingError(f"cannot read the recording {path}: {error}") from error
    if lines == [""]:
        raise RecordingError(f"the recording {path} is empty")
    number = 1
    try:
        header = _Header.model_validate_json(lines[0])
        exchanges = []
        for number, line in enumerate(lines[1:], start=2):  # noqa: B007
            exchanges.append(_Exchange.model_validate_json(line))
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(map(str, first["loc"]))
        raise RecordingError(
            f"{path} line {number} is not of a recording: {where} {first['msg']}"
        ) from error
    return header, exchanges


def _similarity(a: _RecordedQuestion, b: _RecordedQuestion) -> float:
    text = SequenceMatcher(None, a.text, b.text, autojunk=False).quick_ratio()
    return text + 0.5 * (a.kind == b.kind) + 0.5 * (a.images == b.images)


def _images(question: _RecordedQuestion) -> str:
    hashes = " ".join(name[:8] for name in question.images)
    return f"with image {hashes}" if hashes else "without an image"


class ResumingChat:
    """Answers from the recording, in order, and asks the model for everything else.

    So a search that is repeated with the same images asks no question twice. New exchanges are
    appended to the recording immediately. Thread-safe.
    """

    def __init__(self, model: ChatModel, path: Path) -> None:
        """Read the existing recording, and continue it.

        Args:
            model: Model that is asked for what the recording does not hold.
            path: File of the recording; a line that was cut off by a crash is removed from it.

        Raises:
            RecordingError: The file is broken, or cannot be written.
        """
        self._model = model
        self._recorded = ReplayChat(path) if _without_half_a_line(path) else None
        self._recording = RecordingChat(model, path, append=True)

    def identify(self) -> str:
        """The model's name; that of the recording, if there is one."""
        return self._recording.identify() if self._recorded is None else self._recorded.identify()

    def ask(self, question: Question) -> Answer:
        """The recorded answer, or that of the model."""
        answer = None if self._recorded is None else self._recorded.take(question)
        return self._recording.ask(question) if answer is None else answer

    def close(self) -> None:
        """Close the file; the recorded exchanges are on disk already."""
        self._recording.close()


def _without_half_a_line(path: Path) -> int:
    """Remove what follows the last line feed; returns the remaining size, bytes."""
    if not path.exists():
        return 0
    try:
        size = read_own(path, most=_MOST_BYTES).rfind(b"\n") + 1
        with closing(AppendOnlyFile(path)) as file:
            file.cut(size)
    except OSError as error:
        raise RecordingError(f"cannot continue {path}: {error.strerror}") from error
    return size
