"""A corpus of plausible replies, written before the rules that read them."""

from pathlib import Path

import yaml

from hypernav.search.perception.explorers.map_question import summarised

REPLIES = yaml.safe_load((Path(__file__).parent / "block_replies.yaml").read_text(encoding="utf-8"))
OFFERED = [2, 5, 7, 9, 12]


def test_nine_replies_of_ten_need_no_second_call():
    assert len(REPLIES) == 60
    read = [reply for reply in REPLIES if summarised(reply["text"], OFFERED) is not None]
    assert len(read) >= 54


def test_no_reply_is_misread():
    for reply in REPLIES:
        assert summarised(reply["text"], OFFERED) in (reply["number"], None), reply["text"]


def test_the_last_line_counts_whatever_stands_before_it():
    text = "I would answer 5 if the door were open. Answer: 2 was my first thought.\nAnswer: {}"
    assert summarised(text.format(7), OFFERED) == 7
    assert summarised(text.format("block nine"), OFFERED) == 9
    assert summarised(text.format(3), OFFERED) is None
