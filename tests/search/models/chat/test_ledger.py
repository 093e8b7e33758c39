import json
from concurrent.futures import ThreadPoolExecutor

import pytest

from chat_models import Parrot
from hypernav.core.chat import Question
from hypernav.core.errors import ModelUnavailableError
from hypernav.search.models.chat.ledger import Ledger, LedgerChat

GROUND = Question("ground", "Locate every bed")
VERIFY = Question("verify", "Is there a bed?", allowed=("yes", "no"))


def test_sums_by_kind_and_in_total():
    chat = LedgerChat(Parrot("yes"), Ledger())
    for question in (GROUND, VERIFY, VERIFY):
        chat.ask(question)
    book = chat.ledger.as_dict(price_in_per_million=2.0, price_out_per_million=10.0)
    assert book["kinds"]["verify"]["calls"] == 2
    assert book["kinds"]["ground"]["tokens_in"] == 100
    for column in ("calls", "tokens_in", "tokens_out", "seconds", "retries"):
        rows = book["kinds"].values()
        assert book["total"][column] == pytest.approx(sum(row[column] for row in rows))
    assert book["cost"] == pytest.approx((300 * 2.0 + 9 * 10.0) / 1e6)
    json.dumps(book)


def test_no_price_no_cost():
    assert "cost" not in Ledger().as_dict()


def test_faults_are_counted_by_reason():
    chat = LedgerChat(Parrot("maybe", "", ModelUnavailableError("gone")), Ledger())
    chat.ask(VERIFY)
    chat.ask(VERIFY)
    with pytest.raises(ModelUnavailableError):
        chat.ask(VERIFY)
    total = chat.ledger.total.as_dict()
    assert total["faults"] == {"invalid": 1, "unavailable": 1, "unparsable": 1}
    assert total["calls"] == 3


def test_threads_lose_no_count():
    chat = LedgerChat(Parrot("yes"), Ledger())
    with ThreadPoolExecutor(8) as pool:
        list(pool.map(lambda _: chat.ask(GROUND), range(400)))
    assert chat.ledger.total.calls == 400
