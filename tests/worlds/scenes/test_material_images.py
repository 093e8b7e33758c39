"""Decoding of images: what decoders say about broken ones reaches nobody."""

import cv2
import numpy as np

from hypernav.worlds.scenes.material_images import decode_images


def test_broken_images_are_none_without_a_word_of_the_decoders(capfd):
    pixels = np.random.default_rng(0).integers(0, 255, (32, 32, 3), dtype=np.uint8)
    whole = {kind: cv2.imencode(kind, pixels)[1].tobytes() for kind in (".png", ".jpg")}
    contents = {
        "whole": whole[".png"],
        "cut": whole[".png"][:600],
        "damaged": whole[".png"][:500] + b"?" + whole[".png"][501:],
        "words": whole[".jpg"][:300] + bytes(9) + whole[".jpg"][300:],
    }
    images = decode_images(contents)
    assert images["whole"] is not None
    assert np.array_equal(images["whole"].rgb, pixels[..., ::-1])
    assert images["damaged"] is None
    assert capfd.readouterr().err == ""
