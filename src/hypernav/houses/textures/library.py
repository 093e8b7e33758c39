"""The texture library: one picture per key, made once per process and shared by all houses."""

from collections.abc import Callable
from functools import partial

import numpy as np

from hypernav.houses.dice import Dice
from hypernav.houses.textures import pictures, surfaces
from hypernav.houses.textures.noise import Picture

_MAKERS: dict[str, Callable[[Dice], Picture]] = {
    "wood": surfaces.wood,
    "satin": surfaces.satin,
    "planks": surfaces.planks,
    "wide planks": partial(surfaces.planks, rows=6),
    "fabric": surfaces.fabric,
    "coarse fabric": partial(surfaces.fabric, coarse=0.3),
    "pile": surfaces.pile,
    "terry": partial(surfaces.pile, depth=0.22),
    "leather": surfaces.leather,
    "square tiles": surfaces.tiles,
    "large tiles": partial(surfaces.tiles, columns=2, rows=2, joint=0.008, spread=0.04),
    "subway tiles": partial(surfaces.tiles, columns=4, rows=8, brick=True, joint=0.008),
    "mosaic": partial(surfaces.tiles, columns=12, rows=12, joint=0.008, spread=0.35),
    "checker": partial(surfaces.tiles, columns=2, rows=2, joint=0.006, spread=0.6),
    "marble": surfaces.marble,
    "granite": surfaces.granite,
    "plaster": surfaces.plaster,
    "striped wallpaper": partial(surfaces.wallpaper, kind=0),
    "rhomb wallpaper": partial(surfaces.wallpaper, kind=1),
    "flower wallpaper": partial(surfaces.wallpaper, kind=2),
    "brushed": surfaces.brushed,
    "bricks": surfaces.bricks,
    "concrete": surfaces.concrete,
    "wicker": surfaces.wicker,
    "soil": surfaces.soil,
    "leaf": surfaces.leaf,
    "striped leaf": partial(surfaces.leaf, stripes=True),
    "stripes": surfaces.stripes,
    "plaid": surfaces.plaid,
    "floral": surfaces.floral,
    "cardboard": surfaces.cardboard,
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
}


_PICTURES: dict[str, Picture] = {}


def texture(key: str) -> Picture:
    """The picture of a key: a name, or a name with a number for one of its variants ("rug 3").

    Row 0 is the upper edge. The array is shared: it cannot be written to.

    Raises:
        KeyError: No texture has this name.
    """
    if key not in _PICTURES:
        name, _, variant = key.rpartition(" ")
        maker = _MAKERS[name if variant.isdigit() else key]
        keep_texture(key, maker(Dice("texture", key)))
    return _PICTURES[key]


def known_texture(key: str) -> bool:
    """Whether the picture of a key is in memory already."""
    return key in _PICTURES


def keep_texture(key: str, picture: Picture) -> None:
    """Put a picture that was made before into the library."""
    picture.flags.writeable = False
    _PICTURES[key] = picture


def is_picture(array: np.ndarray) -> bool:
    """Whether an array from a file can be a texture."""
    return array.dtype == np.uint8 and array.ndim == 3 and array.shape[2] == 3 and array.size > 0
