"""Images that continue along a surface, such as rows of goods, instead of being fitted to it."""

from hypernav.houses.modelling.mesh import Finish, Mesh
from hypernav.houses.modelling.solids import panel

# A material whose image covers one metre square counts as fitted, and is not repeated.
_TILE_M = 2.0


def repeated_image(key: str) -> Finish:
    """Finish of an image that is a metre wide and repeats; for `repeated_panel`."""
    return Finish(key, (1.0, 1.0, 1.0), _TILE_M, "", "paper")


def repeated_panel(x: float, z: float, shift: float) -> Mesh:
    """Upright rectangle that faces +y, as high as the image; ``shift`` is a share of its width."""
    return panel(x, z).textured(_TILE_M * x, _TILE_M, _TILE_M * shift, 0.0)
