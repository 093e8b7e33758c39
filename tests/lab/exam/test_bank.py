import pytest

from hypernav.core.errors import EpisodeError
from hypernav.lab.datasets.building_splits import EXAM_BUILDINGS, SPLITS
from hypernav.lab.exam.bank import Bank


@pytest.mark.parametrize("name", ["val", "train"])
def test_a_bank_stays_in_its_buildings_and_no_split_begins_there(name):
    numbers = {int(one.scene.partition(":")[2]) for one in Bank(name, "full", ()).sheets()}
    assert numbers <= set(EXAM_BUILDINGS[name])
    assert all(numbers.isdisjoint(split.numbers) for split in SPLITS.values())


@pytest.mark.parametrize("split", [one for one in SPLITS.values() if one.is_open])
def test_an_open_split_may_not_have_buildings_of_the_val_bank(split):
    split.check(range(8990, 9000))
    with pytest.raises(EpisodeError, match="hypernav exam"):
        split.check(range(8999, 9001))
