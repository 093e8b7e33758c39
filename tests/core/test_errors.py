"""What errors say."""

from hypernav.core.errors import ChatError


def test_a_remedy_ends_the_message():
    told = ChatError("the model is not there", remedy="install it")
    assert (str(told), told.remedy) == ("the model is not there; install it", "install it")
    assert str(ChatError("the model is not there")) == "the model is not there"
