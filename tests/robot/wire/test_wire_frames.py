"""Observations as bytes: a round trip loses nothing, and broken bytes have a precise error."""

import io
import struct
import zlib

import numpy as np
import pytest
from PIL import Image

from hypernav.core.embodiment import CameraConfig
from hypernav.core.errors import WireError
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.naming.labels import ObjectLabel
from hypernav.core.observation import LabelledPixels, Observation
from hypernav.robot.client.robot import Sensed
from hypernav.robot.wire.frames import (
    MOST_BODY_BYTES,
    decode_observation,
    pack_observation,
    unpack_observation,
)
from hypernav.robot.wire.requests import ObservationFacts
from hypernav.robot.wire.values import PlanarPose

CAMERA = CameraConfig(width=40, height=30)
FACTS = ObservationFacts(sequence=7, stamp_s=12.5, base_to_odom=PlanarPose(x=1.0, yaw=0.5))


def images() -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(0)
    rgb = rng.integers(0, 255, (30, 40, 3), dtype=np.uint8)
    depth = (rng.integers(0, 5000, (30, 40)) / 1000.0).astype(np.float32)
    return rgb, depth


def decoded(body: bytes) -> Observation:
    packed = unpack_observation(body)
    return decode_observation(packed, CAMERA.intrinsics, CAMERA.camera_to_base)


def test_poses_of_a_robot_with_a_frame_of_its_own_are_taken_to_the_map():
    facts = FACTS.model_copy(update={"base_to_odom": PlanarPose(x=300.0, y=300.0)})
    packed = unpack_observation(pack_observation(facts, *images()))
    with pytest.raises(WireError, match="a map reaches"):
        decode_observation(packed, CAMERA.intrinsics, CAMERA.camera_to_base)
    to_map = facts.base_to_map.inverse()
    seen = decode_observation(packed, CAMERA.intrinsics, CAMERA.camera_to_base, to_map)
    assert np.allclose((*seen.robot.xy, seen.robot.yaw), 0.0)
    assert np.allclose(seen.camera_to_map.matrix, CAMERA.camera_to_base.matrix)


def png(width: int, height: int, depth: int = 16, kind: int = 0, rows: bytes = b"") -> bytes:
    def chunk(name: bytes, data: bytes) -> bytes:
        crc = zlib.crc32(name + data)
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", crc)

    header = struct.pack(">IIBBBBB", width, height, depth, kind, 0, 0, 0)
    body = chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")
    return b"\x89PNG\r\n\x1a\n" + body


def body_of(colour: bytes, depth: bytes, kinds: tuple[str, str] = ("png", "png-mm")) -> bytes:
    header = (
        '{"sequence": 0, "stamp_s": 0, "base_to_odom": {}, '
        f'"colour": {{"format": "{kinds[0]}", "bytes": {len(colour)}}}, '
        f'"depth": {{"format": "{kinds[1]}", "bytes": {len(depth)}}}}}\n'
    )
    return header.encode() + colour + depth


def encoded(array: np.ndarray, kind: str = "PNG") -> bytes:
    file = io.BytesIO()
    Image.fromarray(array).save(file, kind)
    return file.getvalue()


@pytest.mark.parametrize("raw_depth", [False, True])
def test_a_round_trip_loses_nothing(raw_depth):
    rgb, depth = images()
    got = decoded(pack_observation(FACTS, rgb, depth, jpeg_quality=None, raw_depth=raw_depth))
    assert np.array_equal(got.rgb, rgb)
    assert np.array_equal(got.depth, depth)
    assert got.robot.x == 1.0
    assert got.robot.yaw == pytest.approx(0.5)
    assert got.camera_to_map.translation == pytest.approx([1.0, 0.0, CAMERA.height_m])


def test_jpeg_is_near_enough():
    rgb = np.full((30, 40, 3), 90, dtype=np.uint8)
    got = decoded(pack_observation(FACTS, rgb, images()[1]))
    assert np.abs(got.rgb.astype(int) - rgb).max() <= 3


@pytest.mark.parametrize("raw_depth", [False, True])
def test_what_is_no_distance_is_no_return(raw_depth):
    rgb, depth = images()
    depth[0, :4] = [np.nan, np.inf, -1.0, -np.inf]
    got = decoded(pack_observation(FACTS, rgb, depth, raw_depth=raw_depth))
    assert (got.depth[0, :4] == 0.0).all()


def test_nan_of_another_sender_is_no_return():
    depth = images()[1]
    depth[0, :3] = [np.nan, np.inf, -1.0]
    got = decoded(body_of(encoded(images()[0]), depth.tobytes(), ("png", "float32")))
    assert (got.depth[0, :3] == 0.0).all()
    assert np.isfinite(got.depth).all()


def test_labels_come_along():
    rgb, depth = images()
    ids = np.full((30, 40), -1, dtype=np.int32)
    ids[5:9, 5:9] = 3
    truth = LabelledPixels(ids, {3: ObjectLabel("bed", room="bedroom"), 9: ObjectLabel("sofa")})
    got = decoded(pack_observation(FACTS, rgb, depth, truth)).truth
    assert got is not None
    assert np.array_equal(got.ids, ids)
    assert got.labels == {3: ObjectLabel("bed", room="bedroom")}


GREY = encoded(images()[0])
FAR = encoded((images()[1] * 1000).astype(np.uint16))


@pytest.mark.parametrize(
    ("body", "words"),
    [
        (b"", "line of JSON"),
        (b"{}", "line of JSON"),
        (b"{}\n", "sequence: Field required"),
        (b'{"sequence": false}\n', "sequence: Input should be a valid integer"),
        (b'{"sequence": "0"}\n', "sequence: Input should be a valid integer"),
        (body_of(GREY, FAR).replace(b'"sequence"', b'"sequence":5,"sequence"', 1), "twice"),
        (b"[" * 100_000 + b"\n", "header"),
        (b"\xff\n", "header"),
        (b" " * (MOST_BODY_BYTES + 1), "at most"),
        (body_of(GREY, FAR) + b"x", "announces"),
        (body_of(GREY, FAR)[:-1], "announces"),
        (body_of(b"no image", FAR), "neither a PNG nor a JPEG"),
        (body_of(GREY, FAR, ("jpeg", "png-mm")), "not a JPEG"),
        (body_of(GREY, FAR, ("png", "float32")), "4,800 bytes"),
        (body_of(GREY, FAR, ("gif", "png-mm")), "colour.format"),
        (body_of(GREY, GREY), "16 bits"),
        (body_of(GREY, encoded(images()[0], "JPEG")), "16 bits"),
        (body_of(png(40, 30, 8, 2, b""), FAR), "broken"),
        (body_of(GREY, png(40, 30, rows=b"\0" * 100)), "broken"),
        (body_of(png(65_000, 65_000, 8, 2, bytes(10_000)), FAR), "65000 × 65000"),
        (body_of(GREY, png(65_000, 65_000, rows=bytes(10_000))), "65000 × 65000"),
        (body_of(encoded(images()[0][:20]), FAR), "40 × 20 pixels; the search was opened"),
    ],
)
def test_a_broken_observation_says_what_is_wrong(body, words):
    with pytest.raises(WireError, match=words):
        decoded(body)


def test_a_png_that_announces_more_than_comes_is_refused():
    rgb, depth = images()
    good = encoded((depth * 1000.0).astype(np.uint16))
    at = good.index(b"IDAT") - 4
    decoded(body_of(encoded(rgb), good))
    for length in (0xFFFF_FFF0, len(good)):
        broken = good[:at] + struct.pack(">I", length) + good[at + 4 :]
        with pytest.raises(WireError, match="depth image is neither a PNG nor a JPEG"):
            decoded(body_of(encoded(rgb), broken))


def test_a_png_that_holds_more_than_its_pixels_is_refused():
    rgb, _ = images()
    full = png(40, 30, rows=bytes(30 * 81))
    decoded(body_of(encoded(rgb), full))
    for colour, far in (
        (png(40, 30, 8, 2, rows=bytes(3_000_000)), full),
        (encoded(rgb), png(40, 30, rows=bytes(20_000))),
    ):
        with pytest.raises(WireError, match="holds more than the 40 × 30 pixels"):
            decoded(body_of(colour, far))


def test_broken_images_never_surprise():
    rng = np.random.default_rng(1)
    rgb, depth = images()
    whole = [
        pack_observation(FACTS, rgb, depth),
        pack_observation(FACTS, rgb, depth, jpeg_quality=None),
    ]
    refused = 0
    for number in range(300):
        body = bytearray(whole[number % 2])
        for _ in range(int(rng.integers(1, 20))):
            body[int(rng.integers(0, len(body)))] = int(rng.integers(0, 256))
        try:
            decoded(bytes(body))
        except WireError:
            refused += 1
    assert refused > 100


def test_views_show_the_observation_that_the_server_decodes():
    rgb, depth = images()
    depth[0, 0] = np.nan
    rotation = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    mounted = Transform(rotation @ CAMERA.camera_to_base.rotation, np.array([0.1, 0.0, 1.2]))
    sensed = Sensed(
        rgb, depth, Pose2(1.0, 0.5, 0.4), 12.5, Pose2(3.0, -2.0, 1.1), mounted, height_m=0.2
    )
    a, b, c, d = (tuple(row) for row in mounted.matrix.tolist())
    facts = ObservationFacts(
        sequence=7,
        stamp_s=12.5,
        base_to_odom=PlanarPose(x=1.0, y=0.5, yaw=0.4, z=0.2),
        odom_to_map=PlanarPose(x=3.0, y=-2.0, yaw=1.1),
        camera_to_base=(a, b, c, d),
    )
    shown = sensed.observation(CAMERA.intrinsics, CAMERA.camera_to_base)
    sent = decoded(pack_observation(facts, rgb, depth, jpeg_quality=None, raw_depth=True))
    assert np.array_equal(shown.rgb, sent.rgb)
    assert np.array_equal(shown.depth, sent.depth)
    assert shown.camera == sent.camera
    assert np.allclose(shown.camera_to_map.matrix, sent.camera_to_map.matrix)
    assert (*shown.robot.xy, shown.robot.yaw) == pytest.approx((*sent.robot.xy, sent.robot.yaw))
