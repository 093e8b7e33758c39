"""Texture library: one image per key, made once per process and shared by all houses."""

from collections.abc import Callable
from functools import partial

import numpy as np

from hypernav.houses.random_stream import RandomStream
from hypernav.houses.textures import images, public_images, surfaces
from hypernav.houses.textures.noise import Image

_MAKERS: dict[str, Callable[[RandomStream], Image]] = {
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
    "painting": images.painting,
    "screen off": images.screen_off,
    "screen show": images.screen_show,
    "screen desktop": images.screen_desktop,
    "book spines": images.book_spines,
    "clock face": images.clock_face,
    "keyboard": images.keyboard,
    "label": images.label,
    "rug": images.rug,
    "outdoors": images.outdoors,
    "whiteboard": public_images.whiteboard,
    "goods": public_images.goods,
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
