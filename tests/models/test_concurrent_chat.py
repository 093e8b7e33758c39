import asyncio
import time

import pytest

from chat_models import Parrot
from hypernav.core.chat import Question
from hypernav.core.errors import ModelUnavailableError
from hypernav.models.chat_config import ChatConfig
from hypernav.models.concurrent_chat import AsyncChat, ConcurrentChat
from hypernav.models.openai_chat import OpenAiChat
from servers.scripted import ScriptedServer


def questions(count: int) -> list[Question]:
    return [Question("ground", f"Question {number}") for number in range(count)]


def test_questions_overlap_up_to_the_bound(server: ScriptedServer):
    server.brain = lambda asked: asked.text
    server.delay_s = 0.1
    chat = OpenAiChat(server.url, "scripted/Qwen2.5-VL-7B", ChatConfig(), environment={})
    with ConcurrentChat(chat, concurrency=3) as shared:
        futures = [shared.submit(question) for question in questions(9)]
        texts = [future.result().text for future in futures]
    assert texts == [f"Question {number}" for number in range(9)]
    assert server.most_at_once == 3


def test_async_questions_share_the_bound(server: ScriptedServer):
    server.brain = lambda asked: asked.text
    server.delay_s = 0.05
    chat = OpenAiChat(server.url, None, ChatConfig(), environment={})

    async def ask_all(shared: ConcurrentChat) -> list[str]:
        asker = AsyncChat(shared)
        assert await asker.identify() == "scripted/Qwen2.5-VL-7B"
        answers = await asyncio.gather(*(asker.ask(question) for question in questions(8)))
        return [answer.text for answer in answers]

    with ConcurrentChat(chat, concurrency=2) as shared:
        assert asyncio.run(ask_all(shared)) == [f"Question {number}" for number in range(8)]
    assert server.most_at_once == 2


def test_an_error_reaches_the_one_who_asked():
    with ConcurrentChat(Parrot(ModelUnavailableError("gone"))) as shared:
        with pytest.raises(ModelUnavailableError, match="gone"):
            shared.ask(questions(1)[0])
        with pytest.raises(ModelUnavailableError, match="gone"):
            asyncio.run(AsyncChat(shared).ask(questions(1)[0]))


def test_closing_drops_what_has_not_begun():
    shared = ConcurrentChat(Parrot(lambda question: time.sleep(0.05) or "done"), concurrency=1)
    futures = [shared.submit(question) for question in questions(20)]
    shared.close()
    assert futures[-1].cancelled()
    assert all(future.done() for future in futures)
