"""Catalogue of all object models that the generator can make."""

import inspect
from collections.abc import Callable
from types import ModuleType

from hypernav.simulator.houses.modelling.materials import Palette
from hypernav.simulator.houses.modelling.model import Model
from hypernav.simulator.houses.objects.belongings import (
    decor,
    devices,
    household,
    kitchenware,
    leisure,
    luggage_and_tools,
    plants,
    sports,
)
from hypernav.simulator.houses.objects.furniture import (
    beds,
    kitchen_units,
    office_equipment,
    sanitary,
    seating,
    shop_fittings,
    storage,
    tables,
)
from hypernav.simulator.houses.random_stream import RandomStream

Maker = Callable[[RandomStream, Palette], Model]

_FAMILIES: tuple[ModuleType, ...] = (
    *(seating, beds, tables, storage, kitchen_units, sanitary, shop_fittings, office_equipment),
    *(plants, decor, kitchenware, devices, household, leisure, sports, luggage_and_tools),
)


def all_makers() -> dict[str, Maker]:
    """Functions that make a model from random draws and a palette, by ``module.function``."""
    makers: dict[str, Maker] = {}
    for family in _FAMILIES:
        for name, function in vars(family).items():
            if name.startswith("_") or inspect.getmodule(function) is not family:
                continue
            if not inspect.isfunction(function):
                continue
            parameters = list(inspect.signature(function).parameters)
            if parameters[:2] == ["rng", "palette"] and function.__annotations__["return"] is Model:
                makers[f"{family.__name__.rpartition('.')[2]}.{name}"] = function
    return makers
