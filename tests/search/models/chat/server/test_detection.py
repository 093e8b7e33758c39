"""What is said where a server does not have the model that was asked for."""

import pytest

from hypernav.core.errors import ModelRejectedError
from hypernav.search.models.chat.server.dialects import ServerInfo, dialect_named, with_known_models
from hypernav.search.models.chat.server.reply_errors import NotFoundError

URL = "http://127.0.0.1:1/v1"
OTHERS = ("alpha", "bravo", "charlie", "delta")


def told(model: str, models: tuple[str, ...], error=None) -> str:
    server = ServerInfo(model, models, dialect_named("openai"))
    return str(with_known_models(error or NotFoundError("not here"), server, URL))


def test_the_three_closest_names_are_told_or_the_first_three():
    like = ("qwen2.5-vl-7b", "qwen2.5-vl-3b", "qwen2.5-vl-32b", "zzz")
    said = told("qwen2.5-vl-7", like)
    assert f"try openai:{URL}#qwen2.5-vl-7b (or " in said
    assert all(name in said for name in like[:3])
    assert "zzz" not in said
    assert f"try openai:{URL}#alpha (or bravo, charlie)" in told("0123456789", OTHERS)
    assert told("0123456789", ("alpha",)).endswith(f"try openai:{URL}#alpha")


@pytest.mark.parametrize("models", [(), ("mine", "alpha")])
def test_nothing_is_said_of_others_where_the_model_is_there_or_no_list_is(models):
    assert told("mine", models) == "not here"


def test_another_error_tells_of_models_only_if_it_names_this_one():
    assert told("mine", OTHERS, ModelRejectedError("too large")) == "too large"
    assert "has no model 'mine'" in told("mine", OTHERS, ModelRejectedError("what is mine?"))
    assert told("mine", OTHERS, ModelRejectedError("undermined")) == "undermined"
