"""Key images: together they show what was seen, and the least telling go first."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from box_views import CAMERA, room, view_of
from hypernav.core.embodiment import CameraConfig
from hypernav.core.geometry.transforms import Pose2
from hypernav.search.memory.key_images import KeyImages, patches_of, with_patches

SENSOR = CameraConfig(width=CAMERA.width, height=CAMERA.height)
HALL = room(8.0, 6.0)


def taken(images: KeyImages, robot: Pose2, *, new_thing: bool = False, floor: int = 0):
    return images.take(
        view_of(HALL, robot), SENSOR, floor=floor, search=1, shows_new_thing=new_thing
    )


def turned(images: KeyImages, x: float = 4.0) -> KeyImages:
    for k in range(12):
        taken(images, Pose2(x, 3.0, k * np.pi / 6.0))
    return images


def test_a_circle_is_kept_in_fewer_images_that_show_nearly_all_of_it():
    images = turned(KeyImages(10**9))
    shown = set(images.showing)
    seen = [
        patches_of(view_of(HALL, Pose2(4.0, 3.0, k * np.pi / 6.0)), SENSOR, 0) for k in range(12)
    ]
    all_seen = {int(one) for patches in seen for one in patches}
    assert 3 <= len(images.kept) < 12
    assert len(all_seen & shown) >= 0.85 * len(all_seen)


def test_the_same_view_again_tells_nothing_unless_it_shows_a_new_thing():
    images = KeyImages(10**9)
    assert taken(images, Pose2(4.0, 3.0, 0.0)) is not None
    assert taken(images, Pose2(4.0, 3.0, 0.0)) is None
    assert taken(images, Pose2(4.0, 3.0, 0.0), new_thing=True) is not None
    assert taken(images, Pose2(4.0, 3.0, 0.0), floor=1) is not None


def test_colour_and_depth_come_back_as_they_were_but_for_compression():
    image = taken(KeyImages(10**9), Pose2(4.0, 3.0, 0.0))
    assert image is not None
    view = view_of(HALL, Pose2(4.0, 3.0, 0.0))
    assert image.rgb.shape == view.rgb.shape
    assert image.rgb.flags.c_contiguous  # networks take nothing else
    assert image.depth == pytest.approx(view.depth[::4, ::4], abs=0.0006)


def test_patches_can_be_found_again_in_the_kept_depth():
    image = taken(KeyImages(10**9), Pose2(4.0, 3.0, 0.3))
    assert image is not None
    again = with_patches(replace(image, patches=image.patches[:0]))
    common = np.isin(again.patches, image.patches).mean()
    assert common > 0.95


def test_patches_are_found_in_the_depth_of_older_memories_which_kept_more_pixels():
    image = taken(KeyImages(10**9), Pose2(4.0, 3.0, 0.3))
    assert image is not None
    depth = view_of(HALL, Pose2(4.0, 3.0, 0.3)).depth[::2, ::2]
    _, png = cv2.imencode(".png", (depth * 1000.0).astype(np.uint16))
    older = with_patches(replace(image, png=png.tobytes()))
    assert older.patches.tolist() == with_patches(image).patches.tolist()


def test_what_other_images_show_too_is_forgotten_first_and_what_shows_a_thing_last():
    images = KeyImages(10**9)
    for yaw in (0.0, np.pi):
        taken(images, Pose2(4.0, 3.0, yaw))
    twin = taken(images, Pose2(4.0, 3.0, 0.05), new_thing=True)
    assert twin is not None
    size = sum(one.size for one in images.kept)
    assert images.shrink(size, []) == []
    assert images.shrink(size - 1, []) in ([0], [2])
    assert len(images.kept) == 2


def test_a_thing_saves_its_image():
    images = KeyImages(10**9)
    first, twin = (taken(images, Pose2(4.0, 3.0, 0.0), new_thing=True) for _ in range(2))
    assert first is not None
    assert twin is not None
    assert images.shrink(first.size, [twin.number, twin.number]) == [first.number]


def test_any_bound_holds():
    images = turned(KeyImages(10**9))
    for bound in (60_000, 20_000, 1_000, 0):
        images.shrink(bound, [])
        assert sum(one.size for one in images.kept) <= bound
    assert not images.showing


def test_each_of_the_most_telling_shows_what_those_before_do_not_until_all_is_shown():
    first = taken(KeyImages(10**9), Pose2(4.0, 3.0, 0.0))
    assert first is not None
    images = KeyImages(10**9)
    for number, shows in enumerate(([0, 1, 2, 3], [1, 2, 3], [4], [0, 1])):
        images.add(replace(first, number=number, patches=np.array(shows)))
    assert images.most_telling(0, before=2, most=4) == (0, 2, 1, 3)
    assert images.most_telling(0, before=2, most=2) == (0, 2)
