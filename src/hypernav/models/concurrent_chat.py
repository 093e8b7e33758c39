"""Several questions under way at the same time, but never more than a set number."""

import asyncio
from concurrent.futures import Future, ThreadPoolExecutor
from types import TracebackType

from hypernav.core.chat import Answer, Question
from hypernav.core.protocols import ChatModel


class ConcurrentChat:
    """Shares one chat model between many who ask.

    Questions beyond the bound wait in order. The model's own threads only wait for the network, so
    the questions of one step overlap, and so do those of many episodes.
    """

    def __init__(self, model: ChatModel, concurrency: int = 8) -> None:
        """Share the model; at most ``concurrency`` questions are under way."""
        self._model = model
        self._pool = ThreadPoolExecutor(concurrency, thread_name_prefix="hypernav-chat")

    def identify(self) -> str:
        """The model's name."""
        return self._model.identify()

    def ask(self, question: Question) -> Answer:
        """Ask and wait."""
        return self.submit(question).result()

    def submit(self, question: Question) -> "Future[Answer]":
        """Ask and go on; the future holds the answer or the error."""
        return self._pool.submit(self._model.ask, question)

    def close(self) -> None:
        """Give up what has not begun and wait for the rest."""
        self._pool.shutdown(wait=True, cancel_futures=True)

    def __enter__(self) -> "ConcurrentChat":
        """Itself."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Close."""
        self.close()


class AsyncChat:
    """The same for ``async`` programs."""

    def __init__(self, shared: ConcurrentChat) -> None:
        """Ask through a shared model, whose bound holds here too."""
        self._shared = shared

    async def identify(self) -> str:
        """The model's name."""
        return await asyncio.to_thread(self._shared.identify)

    async def ask(self, question: Question) -> Answer:
        """Ask and wait without blocking the event loop."""
        return await asyncio.wrap_future(self._shared.submit(question))
