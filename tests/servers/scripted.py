"""An OpenAI-compatible server whose every word and every failure is scripted.

It speaks HTTP over a real socket (FastAPI, uvicorn), so the package's own HTTP client is tested
against it. Its answers come from a brain, a function of the request; their form from a personality
(which server it imitates); its failures from a plan of failures or from seeded rates.
"""

import asyncio
import base64
import json
import math
import random
import socket
import struct
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any, Literal

import cv2
import numpy as np
import uvicorn
from fastapi import FastAPI, Request
from fastapi.responses import JSONResponse, PlainTextResponse, Response
from uvicorn.protocols.http.h11_impl import H11Protocol

from certainty import certain

Failure = Literal[
    "ok", "429", "500", "hang", "reset", "half", "broken json", "not json", "empty", "refuse"
]
TRANSPORT_FAILURES: tuple[Failure, ...] = (
    "429", "500", "reset", "half", "broken json", "not json", "empty",
)  # fmt: skip


@dataclass
class Asked:
    """One request as a brain sees it."""

    text: str
    images: list[np.ndarray]
    allowed: list[str]
    body: dict[str, Any]

    @property
    def kind(self) -> str:
        """Which of our questions it is, by its words."""
        if self.text.startswith("Locate every"):
            return "ground"
        if "Which numbered block" in self.text:
            return "choose block"
        if self.text.startswith("Is there "):
            return "verify"
        if "Is the robot already VERY close" in self.text:
            return "stop"
        if self.text.startswith("What is the thing in the middle"):
            return "crop"
        if "is what its camera sees now. " in self.text and "red arrow" in self.text.lower():
            return "choose arrow"
        if "In which of these images" in self.text:
            return "choose images"
        if "should it explore more?" in self.text:
            return "choose direction"
        if "likely close by?" in self.text:
            return "score view"
        return "summarise" if "Which number did they choose" in self.text else "other"


@dataclass
class Said:
    """What a brain answers."""

    text: str
    probabilities: dict[str, float] = field(default_factory=dict)


Brain = Callable[[Asked], Said | str]


@dataclass
class Personality:
    """Which server it pretends to be.

    Attributes:
        owned_by: What its model list says.
        models: What it has.
        version: Of vLLM; none if empty.
        honours: Constraints that it obeys; others are ignored silently.
        rejects: Fields of a request that it answers with 400.
        logprobs: Whether it tells them.
        systemone: Whether it has ``/v1/systemone``.
        decisions: Whether it has ``/v1/decisions``.
        sees: Whether it takes images.
        key: What it wants to be sent as a key.
    """

    owned_by: str = "vllm"
    models: tuple[str, ...] = ("scripted/Qwen2.5-VL-7B",)
    version: str = "0.12.1"
    honours: tuple[str, ...] = ("structured_outputs", "response_format")
    rejects: tuple[str, ...] = ()
    logprobs: bool = True
    systemone: bool = False
    decisions: bool = False
    sees: bool = True
    key: str = ""


class _Resettable(H11Protocol):
    """Remembers transports by the client's port, so that a handler can cut its own connection."""

    transports: dict[int, asyncio.Transport] = {}  # noqa: RUF012

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        super().connection_made(transport)
        if self.client is not None:
            self.transports[self.client[1]] = transport


class ScriptedServer:
    """The server. Use as a context manager; settings may be changed while it runs."""

    def __init__(
        self,
        brain: Brain | None = None,
        personality: Personality | None = None,
        *,
        port: int = 0,
        seed: int = 0,
    ) -> None:
        """Prepare; `start` opens the socket."""
        self.brain: Brain = brain or (lambda asked: "ok")
        self.personality = personality or Personality()
        self.plan: deque[Failure] = deque()
        self.rates: Mapping[Failure, float] = {}
        self.delay_s = 0.0
        self.hang_s = 30.0
        self.requests: list[Asked] = []
        self.headers: list[dict[str, str]] = []
        self.failures: list[Failure] = []
        self.most_at_once = 0
        self._at_once = 0
        self._hung = 0
        self._rng = random.Random(seed)
        self._wanted_port = port
        self._server: uvicorn.Server | None = None
        self._thread: threading.Thread | None = None
        self.port = port

    @property
    def url(self) -> str:
        """For an OpenAI client."""
        return f"http://127.0.0.1:{self.port}/v1"

    @property
    def spec(self) -> str:
        """For ``--vlm``."""
        return f"openai:{self.url}"

    def reset(self) -> None:
        """Back to a server that works."""
        self.brain = lambda asked: "ok"
        self.personality = Personality()
        self.plan.clear()
        self.rates = {}
        self.delay_s = 0.0
        self.requests.clear()
        self.headers.clear()
        self.failures.clear()
        self.most_at_once = 0

    def start(self) -> "ScriptedServer":
        """Open the socket and serve in a thread."""
        # Named as TCP, so that asyncio switches off Nagle's algorithm: it delays answers by 40 ms.
        listener = socket.socket(socket.AF_INET, socket.SOCK_STREAM, socket.IPPROTO_TCP)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(("127.0.0.1", self._wanted_port))
        self.port = self._wanted_port = listener.getsockname()[1]
        config = uvicorn.Config(
            self._app(),
            http=_Resettable,
            ws="none",
            lifespan="off",
            log_level="critical",
            timeout_graceful_shutdown=1,
        )
        self._server = uvicorn.Server(config)
        self._thread = threading.Thread(
            target=self._server.run, kwargs={"sockets": [listener]}, daemon=True
        )
        self._thread.start()
        end = time.monotonic() + 10.0
        while not self._server.started and time.monotonic() < end:
            time.sleep(0.005)
        return self

    def stop(self) -> None:
        """Close the socket and all connections."""
        if self._server is not None and self._thread is not None:
            self._server.should_exit = self._server.force_exit = True
            self._thread.join(timeout=5.0)
        self._server = self._thread = None

    def __enter__(self) -> "ScriptedServer":
        return self.start()

    def __exit__(self, *_: object) -> None:
        self.stop()

    def _app(self) -> FastAPI:
        app = FastAPI()

        @app.get("/version")
        def version() -> Response:
            if not self.personality.version:
                return JSONResponse({"detail": "Not Found"}, 404)
            return JSONResponse({"version": self.personality.version})

        @app.get("/v1/models")
        async def models(request: Request) -> Response:
            while self._hung and not await request.is_disconnected():
                await asyncio.sleep(0.01)
            if (denied := self._denied(request)) is not None:
                return denied
            names = self.personality.models
            data = [
                {"id": n, "object": "model", "owned_by": self.personality.owned_by} for n in names
            ]
            return JSONResponse({"object": "list", "data": data})

        @app.post("/v1/chat/completions")
        async def chat(request: Request) -> Response:
            return await self._handle(request, self._chat)

        @app.post("/v1/systemone")
        async def systemone(request: Request) -> Response:
            if not self.personality.systemone:
                return JSONResponse({"detail": "Not Found"}, 404)
            return await self._handle(request, self._systemone)

        @app.post("/v1/decisions")
        async def decisions(request: Request) -> Response:
            if not self.personality.decisions:
                return JSONResponse({"detail": "Not Found"}, 404)
            return await self._handle(request, self._decisions)

        return app

    def _denied(self, request: Request) -> Response | None:
        key = self.personality.key
        sent = request.headers.get("authorization", "")
        if key and sent != f"Bearer {key}":
            return JSONResponse({"error": {"message": f"Incorrect key: {sent[7:]}"}}, 401)
        return None

    async def _handle(
        self, request: Request, answer: Callable[[dict[str, Any]], Response]
    ) -> Response:
        self.headers.append(dict(request.headers))
        if (denied := self._denied(request)) is not None:
            return denied
        body = await request.json()
        if not body:
            return JSONResponse({"detail": "field required"}, 422)
        self._at_once += 1
        self.most_at_once = max(self.most_at_once, self._at_once)
        try:
            if self.delay_s:
                await asyncio.sleep(self.delay_s)
            failure = self._next_failure()
            self.failures.append(failure)
            return await self._fail(failure, request, body, answer)
        finally:
            self._at_once -= 1

    def _next_failure(self) -> Failure:
        if self.plan:
            return self.plan.popleft()
        drawn = self._rng.random()
        for failure, rate in self.rates.items():
            if drawn < rate:
                return failure
            drawn -= rate
        return "ok"

    async def _fail(
        self,
        failure: Failure,
        request: Request,
        body: dict[str, Any],
        answer: Callable[[dict[str, Any]], Response],
    ) -> Response:
        match failure:
            case "429":
                error = {"error": {"message": "slow down"}}
                return JSONResponse(error, 429, headers={"retry-after": "0.01"})
            case "500":
                return JSONResponse({"error": {"message": "internal error"}}, 500)
            case "hang":
                await self._hang(request)
            case "reset":
                self._cut(request)
            case "half":
                whole = bytes(answer(body).body)
                headers = {"content-length": str(len(whole)), "content-type": "application/json"}
                return _Short(whole[: len(whole) // 2], headers=headers)
            case "broken json":
                half = bytes(answer(body).body)[:-20]
                return Response(half, media_type="application/json")
            case "not json":
                return PlainTextResponse("<html>Bad gateway</html>")
            case "empty":
                return JSONResponse({"choices": []})
            case "refuse":
                message = {"role": "assistant", "content": None, "refusal": "I must not look."}
                return self._completion(message, "stop", body)
        return answer(body)

    async def _hang(self, request: Request) -> None:
        """Answer nothing at all, not even what models there are, until the client gives up."""
        self._hung += 1
        end = time.monotonic() + self.hang_s
        while time.monotonic() < end and not await request.is_disconnected():
            await asyncio.sleep(0.01)
        self._hung -= 1

    def _cut(self, request: Request) -> None:
        transport = _Resettable.transports[request.scope["client"][1]]
        raw = transport.get_extra_info("socket")
        raw.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        transport.abort()

    def _chat(self, body: dict[str, Any]) -> Response:
        me = self.personality
        if body.get("model") not in me.models:
            return _error(404, f"The model `{body.get('model')}` does not exist.")
        rejected = [name for name in me.rejects if name in body]
        if rejected:
            return _error(400, f"unknown field: {rejected[0]}")
        asked = _read_chat(body)
        if asked.images and not me.sees:
            return _error(500, "image input is not supported - hint: you may need the mmproj")
        self.requests.append(asked)
        said = self.brain(asked)
        said = Said(said) if isinstance(said, str) else said
        text = self._constrained(said.text, body)
        finish = "stop" if body.get("max_tokens", 999) * 4 >= len(text) else "length"
        text = text[: body.get("max_tokens", 999) * 4]
        message = {"role": "assistant", "content": text}
        logprobs = None
        if body.get("logprobs") and me.logprobs:
            logprobs = {"content": _logprobs(text, said.probabilities)}
        return self._completion(message, finish, body, logprobs)

    def _completion(
        self, message: dict[str, Any], finish: str, body: dict[str, Any], logprobs: Any = None
    ) -> Response:
        choice = {"index": 0, "message": message, "finish_reason": finish, "logprobs": logprobs}
        words = len(str(message.get("content") or "").split())
        usage = {"prompt_tokens": 100 + len(str(body)) // 1000, "completion_tokens": words}
        return JSONResponse(
            {
                "id": "scripted",
                "object": "chat.completion",
                "created": 0,
                "model": body.get("model"),
                "choices": [choice],
                "usage": {**usage, "total_tokens": sum(usage.values())},
            }
        )

    def _constrained(self, text: str, body: dict[str, Any]) -> str:
        """What a constraint makes of a text: the allowed answer in it, else the first."""
        for name, allowed, wrapped in _constraints(body):
            if name in self.personality.honours:
                chosen = next((one for one in allowed if one in text.split()), allowed[0])
                return json.dumps({"answer": chosen}) if wrapped else chosen
        return text

    def _systemone(self, body: dict[str, Any]) -> Response:
        (name, question), *_ = body["questions"].items()
        images = [_decoded(asset["data_base64"]) for asset in body["assets"].values()]
        allowed = list(question["criteria"])
        said = self._decide(Asked(question["instructions"], images, allowed, body))
        answer = {"type": "choice", "choice": said.text, "confidence": 0.5}
        answer["probabilities"] = _all_chances(said, allowed)
        usage = {"input_tokens": 90, "output_tokens": 0}
        return JSONResponse({"model": body["model"], "answers": {name: answer}, "usage": usage})

    def _decisions(self, body: dict[str, Any]) -> Response:
        question = body["questions"][0]
        content = body["input"][0]["content"]
        images = [_decoded(p["image_url"]) for p in content if p["type"] == "input_image"]
        allowed = [choice["value"] for choice in question["choices"]]
        said = self._decide(Asked(question["instructions"], images, allowed, body))
        chances = _all_chances(said, allowed)
        answer = {"type": "choice", "name": question["name"], "choice": said.text}
        answer["probabilities"] = [{"value": k, "probability": v} for k, v in chances.items()]
        usage = {"input_tokens": 90, "output_tokens": 0}
        return JSONResponse({"model": body["model"], "answers": [answer], "usage": usage})

    def _decide(self, asked: Asked) -> Said:
        self.requests.append(asked)
        said = self.brain(asked)
        said = Said(said) if isinstance(said, str) else said
        if said.text not in asked.allowed:
            said.text = asked.allowed[0]
        return said


class _Short(Response):
    """Promises more than it sends, then closes."""

    async def __call__(self, scope: Any, receive: Any, send: Any) -> None:
        start = {"type": "http.response.start", "status": 200, "headers": self.raw_headers}
        await send(start)
        await send({"type": "http.response.body", "body": self.body, "more_body": True})
        _Resettable.transports[scope["client"][1]].close()


def _error(status: int, message: str) -> Response:
    return JSONResponse({"error": {"message": message, "code": status}}, status)


def _read_chat(body: dict[str, Any]) -> Asked:
    content: str | list[dict[str, Any]] = body["messages"][-1]["content"]
    parts: list[dict[str, Any]] = (
        [{"type": "text", "text": content}] if isinstance(content, str) else content
    )
    text = "\n".join(part["text"] for part in parts if part["type"] == "text")
    images = [_decoded(p["image_url"]["url"]) for p in parts if p["type"] == "image_url"]
    allowed = next((allowed for _, allowed, _ in _constraints(body)), [])
    return Asked(text, images, allowed, body)


def _constraints(body: dict[str, Any]) -> Iterator[tuple[str, list[str], bool]]:
    """Name, allowed answers and whether they are wrapped in JSON."""
    if "structured_outputs" in body:
        yield "structured_outputs", body["structured_outputs"]["choice"], False
    if "guided_choice" in body:
        yield "guided_choice", body["guided_choice"], False
    if "regex" in body:
        yield "regex", body["regex"].strip("()").replace("\\", "").split("|"), False
    schema = body.get("response_format", {}).get("json_schema", {}).get("schema", {})
    if "answer" in schema.get("properties", {}):
        yield "response_format", schema["properties"]["answer"]["enum"], True


def _decoded(data_url: str) -> np.ndarray:
    data = np.frombuffer(base64.b64decode(data_url.rpartition(",")[2]), np.uint8)
    return certain(cv2.imdecode(data, cv2.IMREAD_COLOR))[..., ::-1]


def _logprobs(text: str, probabilities: dict[str, float]) -> list[dict[str, Any]]:
    """Character tokens; alternatives to the answer's first character come from the brain."""
    value = text.rpartition('": "')[2].rstrip('"}') if text.startswith("{") else text
    begin = text.rfind(value)
    tokens = []
    for place, character in enumerate(text):
        chances = {character: 1.0}
        said = text[begin:place]
        if probabilities and begin <= place < begin + len(value):
            fitting = {k: p for k, p in probabilities.items() if k.startswith(said)}
            total = sum(fitting.values()) or 1.0
            chances = {}
            for label, p in fitting.items():
                following = label[len(said) : len(said) + 1] or "\n"
                chances[following] = chances.get(following, 0.0) + p / total
        top = [{"token": t, "logprob": math.log(p)} for t, p in chances.items() if p > 0.0]
        own = math.log(max(chances.get(character, 0.0), 1e-9))
        tokens.append({"token": character, "logprob": own, "top_logprobs": top})
    return tokens


def _all_chances(said: Said, allowed: list[str]) -> dict[str, float]:
    if said.probabilities:
        return {answer: said.probabilities.get(answer, 0.0) for answer in allowed}
    return {answer: 1.0 if answer == said.text else 0.0 for answer in allowed}


@contextmanager
def closed_port() -> Iterator[int]:
    """A port on which nobody listens."""
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as held:
        held.bind(("127.0.0.1", 0))
        yield held.getsockname()[1]
