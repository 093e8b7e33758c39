"""Houses for other programs: glTF, Habitat, and a page for people."""

from hypernav.worlds.houses.export.descriptions import describe
from hypernav.worlds.houses.export.files import export_house
from hypernav.worlds.houses.export.page import house_page

__all__ = ["describe", "export_house", "house_page"]
