import pytest
from hypothesis import given
from hypothesis import strategies as st

from chat_models import Parrot
from hypernav.core.chat import Answer, Question
from hypernav.core.errors import ModelUnavailableError
from hypernav.core.exploring.overview import Block, Overview
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.goal import Goal
from hypernav.core.trace import ExchangeLog
from hypernav.search.perception.config import VlmReasonerConfig
from hypernav.search.perception.explorers.geometric_reasoner import GeometricReasoner
from hypernav.search.perception.explorers.map_question import VlmReasoner, summarised
from overviews import BlankOverview

BED = Goal("bed")
PAPER = VlmReasonerConfig(mode="paper", list_excluded=True)
CONSTRAINED = VlmReasonerConfig(mode="constrained")
REASONED = VlmReasonerConfig()
NOTHING = frozenset[int]()


def overview(count: int = 12) -> Overview:
    blocks = tuple(
        Block(n, float(n), 0.0, 2.0, 100, 10 + n, (n + 1.0, 1.0), 3.0) for n in range(1, count + 1)
    )
    return BlankOverview(blocks, Pose2(0.0, 0.0, 0.0))


def reasoner(
    parrot: Parrot, config: VlmReasonerConfig = REASONED
) -> tuple[VlmReasoner, ExchangeLog]:
    log = ExchangeLog()
    return VlmReasoner(parrot, log, GeometricReasoner(log), config), log


def test_constrained_numbers_are_the_only_possible_answers():
    parrot = Parrot("7")
    chooser, log = reasoner(parrot, CONSTRAINED)
    choice = chooser.choose(overview(), BED, frozenset({2, 3}))
    assert choice.number == 7
    (question,) = parrot.asked
    assert question.allowed == ("1", "4", "5", "6", "7", "8", "9", "10", "11", "12")
    assert "blocks: 1, 4, 5, 6, 7, 8, 9, 10, 11, 12." in question.text
    assert question.images[0].shape == (64, 64, 3)
    (exchange,) = log.drain()
    assert (exchange.kind, exchange.chosen, exchange.excluded) == ("choose block", 7, [2, 3])


def test_probabilities_reach_the_choice_and_the_trace():
    class Sure(Parrot):
        def ask(self, question: Question) -> Answer:
            return Answer("7", "m", value="7", probabilities={"7": 0.75, "1": 0.25})

    chooser, log = reasoner(Sure("7"))
    choice = chooser.choose(overview(), BED, NOTHING)
    assert "75% sure" in choice.reason
    assert log.drain()[0].probabilities == {"7": 0.75, "1": 0.25}


def test_paper_mode_reads_free_text_by_rules():
    parrot = Parrot("The bedroom is probably behind block 2, so the robot should go to block 5.")
    chooser, log = reasoner(parrot, PAPER)
    choice = chooser.choose(overview(), BED, NOTHING)
    assert choice.number == 5
    assert "bedroom is probably" in choice.reason
    assert parrot.asked[0].allowed == ()
    assert [exchange.kind for exchange in log.drain()] == ["choose block"]


def test_paper_mode_asks_for_a_summary_where_rules_fail():
    parrot = Parrot("Both 4 and 9 look good, the latter has a door.", "9")
    chooser, log = reasoner(parrot, PAPER)
    assert chooser.choose(overview(), BED, NOTHING).number == 9
    assert [question.kind for question in parrot.asked] == ["choose block", "summarise"]
    assert "Both 4 and 9" in parrot.asked[1].text
    assert parrot.asked[1].images == ()
    assert [exchange.chosen for exchange in log.drain()] == [None, 9]


def test_an_excluded_answer_is_asked_for_again():
    parrot = Parrot("2", "2", "6")
    chooser, log = reasoner(parrot, PAPER)
    assert chooser.choose(overview(), BED, frozenset({2})).number == 6
    assert len(log.drain()) == 3


@pytest.mark.parametrize("config", [PAPER, CONSTRAINED, VlmReasonerConfig()])
@pytest.mark.parametrize("text", ["", "who knows", "99", "I'm sorry, I can't.", "3 or 4"])
def test_ill_formed_answers_fall_back_for_this_choice_only(config: VlmReasonerConfig, text: str):
    parrot = Parrot(text)
    chooser, log = reasoner(parrot, config)
    choice = chooser.choose(overview(), BED, NOTHING)
    assert choice.number == 12  # the geometric reasoner's favourite
    assert choice.reason.startswith("fell back: ")
    assert chooser.fallbacks == 1
    exchanges = log.drain()
    assert exchanges[-1].asked == "geometric"
    assert all(exchange.remarks for exchange in exchanges[:-1])
    parrot.says[:] = ["4"]
    assert chooser.choose(overview(), BED, NOTHING).number == 4
    assert chooser.fallbacks == 1


def test_asking_again_says_what_was_wrong():
    parrot = Parrot("somewhere", "8")
    chooser, _ = reasoner(parrot, CONSTRAINED)
    assert chooser.choose(overview(), BED, NOTHING).number == 8
    assert parrot.asked[0].text != parrot.asked[1].text
    assert "'somewhere'" in parrot.asked[1].text


def test_nothing_left_asks_nobody():
    parrot = Parrot("1")
    chooser, _ = reasoner(parrot)
    assert chooser.choose(overview(2), BED, frozenset({1, 2})).number is None
    assert chooser.choose(overview(2), BED, frozenset({1})).number == 2
    assert parrot.asked == []


def test_an_outage_is_not_a_reason_to_fall_back():
    chooser, _ = reasoner(Parrot(ModelUnavailableError("gone")))
    with pytest.raises(ModelUnavailableError):
        chooser.choose(overview(), BED, NOTHING)
    assert chooser.fallbacks == 0


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("5", 5),
        ("Block 5.", 5),
        ("**5**", 5),
        ("Number: 5", 5),
        ("five", 5),
        ("block five", 5),
        ("I choose block 5 because it is near the hallway.", 5),
        ("Answer: 5", 5),
        ("The answer is **5**.", 5),
        (r"So \boxed{5}", 5),
        ("Blocks 1, 2 and 3 are explored. The robot should go to block 5.", 5),
        ("Block 5 is 3 m away and has a door.", 5),
        ("Not block 2, it was visited. Block 5 looks like a bedroom.", 5),
        ("Avoid 1, 2 and 3. Block 5 is the one to visit.", 5),
        ("I'd recommend heading towards 5", 5),
        ("<think>3? 4?</think>5", 5),
        ("1. Explored: left side. Go to block 5", 5),
        ("", None),
        ("somewhere else", None),
        ("3 or 4", None),
        ("99", None),
        ("Block 99", None),
        ("Go to 3 first, then go to 4.", None),
        ("It is 3 m away", None),
        ("block 2.5", None),
        ("Answer: block 3 or 7", None),
        ("Answer: 3? No, 7.", None),
        ("I would rule out 3.", None),
        ("Skip block 3; it is a closet.", None),
        ("choose" + " " * 32_000 + "x", None),
        ("!" * 32_000, None),
        ("Answer " + "*" * 32_000, None),
        ("\n" * 32_000, None),
    ],
)
def test_rules_of_the_summariser(text: str, number: int | None):
    assert summarised(text, list(range(1, 13))) == number


@given(st.text(max_size=300), st.sets(st.integers(1, 30), min_size=1))
def test_the_summariser_answers_what_is_possible_or_nothing(text: str, numbers: set[int]):
    number = summarised(text, sorted(numbers))
    assert number is None or number in numbers


@given(st.integers(1, 12), st.sampled_from(["{}", "block {}", "Go to block {}.", "Answer: {}"]))
def test_plain_answers_are_always_understood(number: int, form: str):
    assert summarised(form.format(number), list(range(1, 13))) == number
