"""Decision endpoints: closed questions answered with a probability for every allowed answer.

No text is generated: the server reads the scores of the answers' labels in one forward pass. Two
forms exist: System One (``POST /v1/systemone``; ``transformers serve``, see
``transformers/cli/serving/systemone.py``) and OpenAI's Decisions (``POST /v1/decisions``; see
``openai/types/decision_create_params.py``; also SGLang and LiteLLM).
"""

import reprlib
from typing import Any

from hypernav.core.chat import Question, Usage
from hypernav.core.errors import ChatTransportError
from hypernav.models.chat.image_encoding import jpeg_base64, jpeg_data_url
from hypernav.models.chat.server.reply_fields import finite_number, read_usage

_QUESTION = "question"
_SYSTEMONE_LIMIT = 26
_SYSTEMONE_IMAGES = 4
_DECISIONS_LIMIT = 255


def accepts_question(endpoint: str, question: Question) -> bool:
    """Whether the question is closed and within the endpoint's limits of answers and images."""
    answers = len(question.allowed)
    if endpoint == "systemone":
        return 2 <= answers <= _SYSTEMONE_LIMIT and len(question.images) <= _SYSTEMONE_IMAGES
    return endpoint == "decisions" and 2 <= answers <= _DECISIONS_LIMIT


def decision_request(
    endpoint: str, model: str, question: Question, *, quality: int
) -> dict[str, Any]:
    """Request body for a closed question.

    Args:
        endpoint: "systemone" or "decisions".
        model: Name of the model on the server.
        question: Closed question, accepted by `accepts_question`.
        quality: JPEG quality of the images, 1 to 100.
    """
    if endpoint == "systemone":
        assets = {
            f"<picture-{number}>": {
                "type": "image",
                "format": "jpeg",
                "data_base64": jpeg_base64(image, quality=quality),
            }
            for number, image in enumerate(question.images, start=1)
        }
        choice = {
            "type": "choice",
            "instructions": question.text,
            "criteria": dict.fromkeys(question.allowed),
        }
        state = "\n".join(assets)
        return {"model": model, "state": state, "questions": {_QUESTION: choice}, "assets": assets}
    images = [
        {"type": "input_image", "image_url": jpeg_data_url(image, quality=quality)}
        for image in question.images
    ]
    content = [*images, {"type": "input_text", "text": question.text}]
    return {
        "model": model,
        "input": [{"type": "message", "role": "user", "content": content}],
        "questions": [
            {
                "type": "choice",
                "name": _QUESTION,
                "instructions": question.text,
                "choices": [{"value": answer} for answer in question.allowed],
            }
        ],
    }


def parse_decision(
    endpoint: str, reply: dict[str, Any], question: Question
) -> tuple[str, dict[str, float], Usage, bool]:
    """Chosen answer, probabilities of the allowed answers, token usage, and whether it was refused.

    Raises:
        ChatTransportError: The reply does not have the endpoint's form.
    """
    answers = reply.get("answers")
    answer = answers.get(_QUESTION) if isinstance(answers, dict) else None
    if isinstance(answers, list) and answers:
        answer = answers[0]
    if not isinstance(answer, dict):
        raise ChatTransportError(f"the {endpoint} endpoint sent no answer: {reprlib.repr(reply)}")
    usage = read_usage(reply.get("usage"))
    if answer.get("type") == "refusal":
        return "", {}, usage, True
    probabilities = _probabilities(answer.get("probabilities"), question.allowed)
    chosen = answer.get("choice")
    if not isinstance(chosen, str) or not probabilities:
        raise ChatTransportError(f"the {endpoint} endpoint sent no choice: {reprlib.repr(answer)}")
    return chosen, probabilities, usage, False


def _probabilities(value: object, allowed: tuple[str, ...]) -> dict[str, float]:
    """Probabilities of all allowed answers; empty if one is missing or none is above 0."""
    if isinstance(value, list):
        entries = [entry for entry in value if isinstance(entry, dict)]
        value = {str(entry.get("value")): entry.get("probability") for entry in entries}
    if not isinstance(value, dict):
        return {}
    shares = [finite_number(value.get(answer)) for answer in allowed]
    known = [share for share in shares if share is not None and 0.0 <= share <= 1.0]
    total = sum(known)
    if len(known) < len(allowed) or total <= 0.0:
        return {}
    return {answer: share / total for answer, share in zip(allowed, known, strict=True)}
