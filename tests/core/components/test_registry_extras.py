import math

import pytest

from hypernav.core.components.registry import require
from hypernav.core.errors import MissingExtraError


def test_an_installed_module_is_returned():
    assert require("math", extra="none") is math


def test_a_missing_module_says_how_to_get_it():
    with pytest.raises(MissingExtraError, match=r"pip install 'hypernav\[onnx\]'"):
        require("no_such_module_at_all", extra="onnx")
