"""What a model server can do wrong, as data: a name, what it does, and how a search must end.

A search ends with 1 where the answers are merely of no use (two steps, and no bed was found), with
2 where URL, key or model are wrong, and with 3 where no answer comes within the patience.
"""

import functools
import gzip
import json
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from servers.faulty import MODEL, Act, Talk, answer_version, completion, list_models

OK = b"HTTP/1.1 200 OK\r\n"
CHUNKED = OK + b"transfer-encoding: chunked\r\n\r\n"
EVIL = "\x1b]0;owned\x07\x1b[31m \x9b31m \u202egnp.exe"
NAN = float("nan")
HALF_A_LABEL = r'[{"bbox_2d": [5, 5, 50, 40], "label": "\ud800"}]'
NO_USE = "no answer of the model could be used"
MODELS = {"object": "list", "data": [{"id": MODEL, "owned_by": "vllm"}]}


@dataclass(frozen=True)
class Fault:
    """One way to be broken.

    Attributes:
        name: What the server does, in words.
        status: Exit status of a search.
        words: What the search says on the terminal.
        act: What it does with a question.
        models: What it does when asked for its models.
        other: What it does with any other request, such as for its version.
    """

    name: str
    status: int
    words: tuple[str, ...]
    act: Act
    models: Act = list_models
    other: Act = answer_version


def _then(*acts: Act) -> Act:
    """One after the other on the same connection."""

    def act(talk: Talk) -> None:
        for one in acts:
            one(talk)

    return act


def _send(data: bytes) -> Act:
    return lambda talk: talk.send(data)


def _repeat(data: bytes, every_s: float = 0.0) -> Act:
    return lambda talk: talk.repeat(data, every_s)


def _reply(body: Any, status: object = 200, **headers: str) -> Act:
    return lambda talk: talk.reply(body, status, **headers)


def _error(text: Any, status: object = 500, **headers: str) -> Act:
    return _reply({"error": {"message": text}}, status, **headers)


def _say(content: Any, **changes: Any) -> Act:
    return lambda talk: talk.say(content, **changes)


def _silence(talk: Talk) -> None:
    talk.wait()


def _after(good: int, act: Act) -> Act:
    """Answers well some times, then does otherwise."""
    return lambda talk: talk.say("[]") if talk.number < good else act(talk)


@functools.cache
def _bomb(pack: Callable[[bytes, int], bytes]) -> bytes:
    return pack(bytes(600_000_000), 1)


def _packed(pack: Callable[[bytes, int], bytes], coding: str) -> Act:
    return lambda talk: talk.reply(_bomb(pack), content_encoding=coding)


def _late(name: str, act: Act) -> Fault:
    """No answer within the patience."""
    return Fault(name, 3, ("within a patience of",), act)


def _of_no_use(name: str, act: Act) -> Fault:
    return Fault(name, 1, (NO_USE,), act)


def _harmless(name: str, act: Act) -> Fault:
    return Fault(name, 1, ("did not find",), act)


def _wrong_setup(name: str, word: str, act: Act) -> Fault:
    return Fault(name, 2, (word,), act)


def _list(name: str, status: int, word: str, models: Act) -> Fault:
    """A fault of the list of models; questions are answered well."""
    return Fault(f"the list of models: {name}", status, (word,), _say("[]"), models)


def _version(name: str, status: int, word: str, other: Act) -> Fault:
    """A fault of whatever is asked beside the API; questions are answered well."""
    return Fault(f"the version: {name}", status, (word,), _say("[]"), other=other)


SLOW = (
    _late("a body byte by byte", _then(_send(OK + b"\r\n"), _repeat(b" ", 0.02))),
    _late("headers without end", _then(_send(OK), _repeat(b"x: y\r\n", 0.02))),
    _late("a header byte by byte", _then(_send(OK + b"x: "), _repeat(b"y", 0.02))),
    _late("a status line byte by byte", _repeat(b"H", 0.02)),
    _late("100 Continue slowly", _repeat(b"HTTP/1.1 100 Continue\r\n\r\n", 0.02)),
    _late("chunks of a byte", _then(_send(CHUNKED), _repeat(b"1\r\nx\r\n", 0.02))),
    _late("trailers slowly", _then(_send(CHUNKED + b"0\r\n"), _repeat(b"x: y\r\n", 0.02))),
    _late("silence", _silence),
    _late("silence after the headers", _then(_send(OK + b"\r\n"), _silence)),
    _late("half an answer, then silence", _then(_send(OK + b'\r\n{"choices": ['), _silence)),
    _late("a good answer that comes late", _then(lambda talk: talk.wait(5.0), _say("[]"))),
    _late("silence after a good answer", _after(1, _silence)),
    _late("an error byte by byte", lambda talk: talk.drip(b"HTTP/1.1 500 No\r\n\r\n" + b"x" * 999)),
    _list("byte by byte", 3, "patience", _then(_send(OK + b"\r\n"), _repeat(b" ", 0.02))),
    _list("silence", 3, "patience", _silence),
    _list("100 Continue", 3, "patience", _repeat(b"HTTP/1.1 100 Continue\r\n\r\n", 0.02)),
    _version("byte by byte", 3, "patience", _then(_send(OK + b"\r\n"), _repeat(b" ", 0.02))),
    _version("silence", 3, "patience", _silence),
)

LARGE = (
    _late("a body without end", _then(_send(OK + b"\r\n"), _repeat(b" " * 65536))),
    _late(
        "a terabyte, as announced",
        _then(_send(OK + b"content-length: 1000000000000\r\n\r\n"), _repeat(b" " * 65536)),
    ),
    _late("chunks without end", _then(_send(CHUNKED), _repeat(b"4000\r\n" + b" " * 16386))),
    _late("chunks of a byte at full speed", _then(_send(CHUNKED), _repeat(b"1\r\nx\r\n" * 9999))),
    _late("trailers at full speed", _then(_send(CHUNKED + b"0\r\n"), _repeat(b"x: y\r\n" * 9999))),
    _late("100 Continue at full speed", _repeat(b"HTTP/1.1 100 Continue\r\n\r\n" * 999)),
    _late("a header without end", _then(_send(OK + b"x: "), _repeat(b"y" * 65536))),
    _late("a hundred large headers", _then(_send(OK), _repeat(b"x: " + b"y" * 60_000 + b"\r\n"))),
    _late("a gzip bomb", _packed(gzip.compress, "gzip")),
    _late("a deflate bomb", _packed(zlib.compress, "deflate")),
    _late("a bomb in a bomb", _packed(gzip.compress, "gzip, gzip")),
    _late("millions of empty lists", _reply(b'{"choices": [' + b"[]," * 1_350_000 + b"[]]}")),
    _late("a list that is no JSON", _reply(b"[" + b"{}," * 1_350_000)),
    _of_no_use("an answer of two megabytes", _say("a bed " * 350_000)),
    _of_no_use("an answer of brackets", _say("[{" * 16_000)),
    _of_no_use("an answer of quotes", _say('{"bbox_2d": "' * 2_500)),
    _of_no_use("an answer of spaces", _say(" " * 2_000_000)),
    _of_no_use("thoughts without end", _say("<think>" * 300_000)),
    _of_no_use("ten thousand boxes", _say(json.dumps([{"bbox_2d": [9, 9, 9, 9]}] * 10_000))),
    _late("an error of two megabytes", _error("no " * 700_000)),
    _of_no_use(
        "a refusal of two megabytes",
        _reply({"choices": [{"message": {"content": None, "refusal": "no " * 700_000}}]}),
    ),
    _list("a name of a megabyte", 2, "lists no model", _reply({"data": [{"id": "x" * 10**6}]})),
    _list(
        "100,000 models",
        2,
        "several models",
        _reply({"data": [{"id": f"m{k}"} for k in range(10**5)]}),
    ),
)

BROKEN_JSON = (
    _late("brackets 200,000 deep", _reply(b"[" * 200_000)),
    _late("objects 100,000 deep", _reply(b'{"a":' * 100_000)),
    _late("a choice 100,000 deep", _reply(b'{"choices":' + b"[" * 100_000 + b"]" * 100_000 + b"}")),
    _late("nothing", _reply(b"")),
    _late("null", _reply(b"null")),
    _late("a number", _reply(b"7")),
    _late("a list", _reply(b"[]")),
    _late("a text", _reply(b'"a bed"')),
    _late("a page", _reply(b"<html>Bad gateway</html>", content_type="text/html")),
    _late("half of it", _reply(b'{"choices": [{"message": {"con')),
    _late("an integer of 5,000 digits", _reply(b'{"choices": ' + b"9" * 5_000 + b"}")),
    _late("bytes that are no text", _reply(b'{"choices": "\xff\xfe\xfa"}')),
    _late("no choices", _reply({})),
    _late("choices that are null", _reply({"choices": None})),
    _late("choices that are an object", _reply({"choices": {}})),
    _late("a choice that is null", _reply({"choices": [None]})),
    _late("a message that is null", _reply({"choices": [{"message": None}]})),
    _late("a message that is a list", _reply({"choices": [{"message": ["a bed"]}]})),
    Fault(
        "an error with status 200",
        3,
        ("answered 200 with an error: the model has crashed",),
        _error("the model has crashed", 200),
    ),
    _late("a passing error with status 200", _error("the model is busy", 200)),
    _harmless("UTF-16", _reply(json.dumps(completion("[]")).encode("utf-16"))),
    _harmless("a byte order mark", _reply(json.dumps(completion("[]")).encode("utf-8-sig"))),
)

STRANGE_ANSWERS = (
    _of_no_use("in an answer, null", _say(None)),
    _of_no_use("in an answer, an empty text", _say("")),
    _of_no_use("in an answer, a number", _say(7)),
    _of_no_use("in an answer, an object", _say({"text": "[]"})),
    _of_no_use("in an answer, lists in lists", _say([[[["a bed"]]]])),
    _of_no_use(
        "in an answer, parts without text", _say([{"type": "image_url"}, None, 7, {"text": [1]}])
    ),
    _harmless(
        "in an answer, parts", _say([{"type": "text", "text": "["}, {"type": "text", "text": "]"}])
    ),
    _of_no_use(
        "in an answer, a refusal",
        _reply({"choices": [{"message": {"refusal": "I must not look."}}]}),
    ),
    _of_no_use("in an answer, a filter", _reply(completion(None, finish_reason="content_filter"))),
    _of_no_use(
        "in an answer, a call of a tool", _reply(completion(None, finish_reason="tool_calls"))
    ),
    _of_no_use("in an answer, babble", _say("I like trains")),
    _of_no_use("in an answer, escapes", _say(EVIL)),
    _of_no_use("in an answer, half a character", _say("\ud800\udc80\udfff")),
    _of_no_use("in an answer, null characters", _say("\x00" * 99)),
    _of_no_use("in an answer, a page with a script", _say("<script>alert(1)</script>")),
    _of_no_use(
        "in an answer, boxes of NaN",
        _reply(b'{"choices":[{"message":{"content":"[{\\"bbox_2d\\":[NaN]}]"}}]}'),
    ),
    _of_no_use(
        "in an answer, boxes beyond everything", _say('[{"bbox_2d": [1e999, -1e999, 1e308, 9]}]')
    ),
    _harmless(
        "in an answer, labels that are escapes",
        _say(json.dumps([{"bbox_2d": [1, 1, 9, 9], "label": EVIL}])),
    ),
    _harmless(
        "in an answer, negative counts",
        _say("[]", usage={"prompt_tokens": -5, "completion_tokens": -5}),
    ),
    Fault("in an answer, half a label", 1, ("did not find the bed",), _say(HALF_A_LABEL)),
    _harmless("in an answer, counts of 400 digits", _say("[]", usage={"prompt_tokens": 10**400})),
    _harmless("in an answer, counts of NaN", _say("[]", usage={"prompt_tokens": NAN})),
    _harmless("in an answer, counts that are texts", _say("[]", usage={"prompt_tokens": "many"})),
    _harmless("in an answer, usage that is a list", _say("[]", usage=[1, 2])),
    _harmless(
        "in an answer, probabilities of NaN",
        _reply(completion("[]", logprobs={"content": [float("nan")]})),
    ),
)

STATUSES = (
    *(
        _late(f"status {status}", _error("try later", status))
        for status in (408, 429, 500, 502, 503)
    ),
    *(_late(f"status {status}", _error("what?", status)) for status in (101, 103, 599, 999)),
    *(_late(f"status {status}", _reply(b"", status)) for status in (204, 205, 206)),
    *(
        _wrong_setup(f"status {status}", f"answered {status}", _error("no", status))
        for status in (300, 304, 401, 402, 403, 404, 405, 410, 418, 451)
    ),
    *(
        Fault(f"status {status}", 3, (f"answered {status}",), _error("what?", status))
        for status in (400, 413, 422)
    ),
    *(
        _late(f"Retry-After: {wait}", _error("busy", 429, retry_after=wait))
        for wait in ("nan", "inf", "-inf", "-5", "0", "1e999", "9" * 999, "soon", "1e-9")
    ),
    *(
        _late(f"status line {line!r}", _send(line))
        for line in (b"HTTP/1.1\r\n\r\n", b"HTTP/1.1 2x0\r\n\r\n")
    ),
    _wrong_setup(
        "a redirection to itself", "points to", _reply(b"", 307, location="/v1/chat/completions")
    ),
    _wrong_setup(
        "a redirection elsewhere", "points to", _reply(b"", 302, location="http://127.0.0.1:1/")
    ),
    _wrong_setup("a redirection to nowhere", "points to nowhere", _reply(b"", 301)),
    _wrong_setup(
        "a redirection to a file", "points to", _reply(b"", 308, location="file:///etc/passwd")
    ),
    _wrong_setup(
        "a redirection with escapes", "points to", _reply(b"", 308, location="\x1b[31m\x9b")
    ),
    _wrong_setup(
        "a key that is wrong from the third question on", "401", _after(1, _error("no", 401))
    ),
)

ERROR_TEXTS = (
    _late("an error with escapes", _error(EVIL)),
    _wrong_setup("a denial with escapes", r"\x1b]0;owned", _error(EVIL, 401)),
    _late("an error that is no JSON", _reply(EVIL.encode(), 500)),
    _late("an error of bytes", _reply(bytes(range(256)), 500)),
    _late("an error 100,000 deep", _reply(b'{"error":' * 100_000, 500)),
    _late("an error in an error", _error({"message": {"message": [EVIL]}})),
    _wrong_setup(
        "an error of half a character", "answered 401", _reply(b'{"error": "\\ud800"}', 401)
    ),
    _wrong_setup("an error with markup", "[/red]", _error("[/red] [bold", 401)),
    _wrong_setup("an error of many lines", "a b c", _error("a\nb\r\nc", 401)),
)

BROKEN_HTTP = (
    _late("a reset", lambda talk: talk.reset()),
    _late("a reset within the answer", _then(_send(OK), lambda talk: talk.reset())),
    _late("no reply", lambda talk: None),
    _late("another protocol", _send(b"SSH-2.0-OpenSSH_9.6\r\n")),
    _late("an alert of TLS", _send(b"\x15\x03\x01\x00\x02\x02\x28")),
    _late("HTTP/0.9", _send(b"<html>hello</html>")),
    _late("HTTP/9.9", _send(b"HTTP/9.9 200 OK\r\n\r\n{}")),
    _late("null characters", _send(b"\x00" * 9999)),
    _late("a header without a colon", _send(OK + b"nothing\r\n\r\n")),
    _late("a header of bytes", _send(OK + bytes(range(128, 256)) + b": x\r\n\r\n")),
    _late("a negative length", _send(OK + b"content-length: -1\r\n\r\n")),
    _late("a length that is no number", _send(OK + b"content-length: much\r\n\r\n")),
    _late("a length of 5,000 digits", _send(OK + b"content-length: " + b"9" * 5000 + b"\r\n\r\n")),
    _late("two lengths", _send(OK + b"content-length: 2\r\ncontent-length: 9\r\n\r\n{}")),
    _late("more promised than sent", _send(OK + b"content-length: 999\r\n\r\n{}")),
    _late("chunks that are none", _send(CHUNKED + b"hello\r\n")),
    _late("a negative chunk", _send(CHUNKED + b"-5\r\nhello\r\n")),
    _late("a chunk of exabytes", _send(CHUNKED + b"f" * 15 + b"\r\nhello")),
    _late("a chunk of 60,000 digits", _send(CHUNKED + b"f" * 60_000 + b"\r\nhello")),
    _late("chunks without an end", _send(CHUNKED + b"2\r\n{}\r\n")),
    _late("an unknown packing", _reply(b"{}", content_encoding="br")),
    _late("a packing of escapes", _reply(b"{}", content_encoding="\x1b[31m")),
    _late("a broken packing", _reply(b"not gzip", content_encoding="gzip")),
    _late(
        "a packing that ends early",
        _reply(gzip.compress(b"{}" * 999)[:20], content_encoding="gzip"),
    ),
    _harmless(
        "a packing that nobody asked for",
        _reply(gzip.compress(json.dumps(completion("[]")).encode()), content_encoding="gzip"),
    ),
)

BROKEN_LISTS = (
    _list("empty", 2, "lists no model", _reply({"data": []})),
    _list("null", 2, "lists no model", _reply({"data": None})),
    _list("no names", 2, "lists no model", _reply({"data": [{"id": 7}, None, {"id": ""}]})),
    _list("two models", 2, "several models", _reply({"data": [{"id": "a"}, {"id": "b"}]})),
    _list("a name too many", 1, "did not find", _reply({"data": [{"id": EVIL}, {"id": MODEL}]})),
    _list("a name of escapes", 2, "lists no model", _reply({"data": [{"id": f"qwen3-vl{EVIL}"}]})),
    _list("a wrong key", 2, "answered 401", _error("no", 401)),
    _list("not found", 2, "answered 404", _error("no", 404)),
    _list("a broken server", 3, "answered 500", _error("no", 500)),
    _list("a page", 3, "not JSON", _reply(b"<html>")),
    _list("200,000 deep", 3, "not JSON", _reply(b"[" * 200_000)),
    _list("no owner", 1, "did not find", _reply({"data": [{"id": MODEL, "owned_by": [7]}]})),
    _version("a page", 3, "not JSON", _reply(b"<html>")),
    _version("a number of 5,000 digits", 1, "did not find", _reply({"version": "9" * 5000 + ".1"})),
    _version("an object", 1, "did not find", _reply({"version": {"major": 1}})),
    _version("not found", 1, "did not find", _error("no", 404)),
)  # fmt: skip

FAULTS = (
    *SLOW,
    *LARGE,
    *BROKEN_JSON,
    *STRANGE_ANSWERS,
    *STATUSES,
    *ERROR_TEXTS,
    *BROKEN_HTTP,
    *BROKEN_LISTS,
)
