"""Texture library: one image per key, made once per process and shared by all houses."""

from collections.abc import Callable
from functools import partial

import numpy as np

from hypernav.simulator.houses.random_stream import RandomStream
from hypernav.simulator.houses.textures import patterns, pictures
from hypernav.simulator.houses.textures.patterns import Image

_MAKERS: dict[str, Callable[[RandomStream], Image]] = {
    "wood": patterns.wood,
    "satin": patterns.satin,
    "planks": patterns.planks,
    "wide planks": partial(patterns.planks, rows=6),
    "fabric": patterns.fabric,
    "coarse fabric": partial(patterns.fabric, coarse=0.3),
    "pile": patterns.pile,
    "terry": partial(patterns.pile, depth=0.22),
    "leather": patterns.leather,
    "square tiles": patterns.tiles,
    "large tiles": partial(patterns.tiles, columns=2, rows=2, joint=0.008, spread=0.04),
    "subway tiles": partial(patterns.tiles, columns=4, rows=8, brick=True, joint=0.008),
    "mosaic": partial(patterns.tiles, columns=12, rows=12, joint=0.008, spread=0.35),
    "marble": patterns.marble,
    "granite": patterns.granite,
    "plaster": patterns.plaster,
    "striped wallpaper": partial(patterns.wallpaper, kind=0),
    "rhomb wallpaper": partial(patterns.wallpaper, kind=1),
    "flower wallpaper": partial(patterns.wallpaper, kind=2),
    "brushed": patterns.brushed,
    "bricks": patterns.bricks,
    "concrete": patterns.concrete,
    "wicker": patterns.wicker,
    "soil": patterns.soil,
    "leaf": patterns.leaf,
    "striped leaf": partial(patterns.leaf, stripes=True),
    "stripes": patterns.stripes,
    "plaid": patterns.plaid,
    "floral": patterns.floral,
    "cardboard": patterns.cardboard,
    "painting": pictures.painting,
    "screen off": pictures.screen_off,
    "screen show": pictures.screen_show,
    "screen desktop": pictures.screen_desktop,
    "book spines": pictures.book_spines,
    "clock face": pictures.clock_face,
    "keyboard": pictures.keyboard,
    "label": pictures.label,
    "rug": pictures.rug,
    "outdoors": pictures.outdoors,
    "whiteboard": pictures.whiteboard,
    "goods": pictures.goods,
}


_TEXTURES: dict[str, Image] = {}


def texture(key: str) -> Image:
    """Texture image of a key: a name, or a name with a number for one of its variants ("rug 3").

    Row 0 is the upper edge. The array is shared and therefore read-only.

    Raises:
        KeyError: No texture has this name.
    """
    if key not in _TEXTURES:
        name, _, variant = key.rpartition(" ")
        maker = _MAKERS[name if variant.isdigit() else key]
        store_texture(key, maker(RandomStream("texture", key)))
    return _TEXTURES[key]


def is_loaded(key: str) -> bool:
    """Whether the texture of a key is in memory already."""
    return key in _TEXTURES


def store_texture(key: str, image: Image) -> None:
    """Add a texture that was made before to the library; it becomes read-only."""
    image.flags.writeable = False
    _TEXTURES[key] = image


def is_image(array: np.ndarray) -> bool:
    """Whether an array from a file can be a texture."""
    return array.dtype == np.uint8 and array.ndim == 3 and array.shape[2] == 3 and array.size > 0
