"""Homes and offices with two or three storeys: even numbers are homes, odd ones are offices."""

from hypernav.houses.kinds.building_kind import BuildingKind
from hypernav.houses.kinds.homes import HOMES
from hypernav.houses.kinds.offices import OFFICES
from hypernav.houses.plan.storey_plans import HOME_STOREYS, OFFICE_STOREYS, StoreyProgram


def kind_of(number: int) -> BuildingKind:
    """Finishes and furniture of the building with a number."""
    return OFFICES if number % 2 else HOMES


def program_of(number: int) -> StoreyProgram:
    """Rooms of the building with a number."""
    return OFFICE_STOREYS if number % 2 else HOME_STOREYS
