"""A chat model that continues after its recording, for a restart after a crash."""

from pathlib import Path

from hypernav.core.chat import Answer, Question
from hypernav.core.components.protocols import ChatModel
from hypernav.core.errors import RecordingError
from hypernav.models.chat.recording import RecordingChat, ReplayChat


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
        size = path.read_bytes().rfind(b"\n") + 1
        with path.open("r+b") as file:
            file.truncate(size)
    except OSError as error:
        raise RecordingError(f"cannot continue {path}: {error.strerror}") from error
    return size
