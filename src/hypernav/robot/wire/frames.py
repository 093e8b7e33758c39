"""Observations as bytes, the same over HTTP and WebSocket.

One line of JSON (`ObservationHeader`), a line feed, and then the images one after the other, each
as long as the header says: colour, depth, and in simulation labels. So a shell can send one::

    { cat header.json; cat colour.jpg depth.png; } | curl --data-binary @- …

Every size is checked before anything is decompressed.
"""

import io
import struct
import zlib
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, UInt8, UInt16
from PIL import Image
from pydantic import ValidationError

from hypernav.core.errors import WireError
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.observation import LabelledPixels, Observation
from hypernav.io.reading import image_size
from hypernav.robot.wire.requests import (
    ColourPart,
    DepthPart,
    LabelsPart,
    ObservationFacts,
    ObservationHeader,
)
from hypernav.robot.wire.values import MAP_REACH_M, repeated_key

MOST_HEADER_BYTES = 300_000
MOST_BODY_BYTES = 20_000_000
"""Size of the longest observation: 1920 × 1080 with raw depth and labels fits."""

_MILLIMETRES = 1000.0
_FARTHEST_MM = 65_535
_PNG = b"\x89PNG\r\n\x1a\n"
_MOST_BYTES_A_PIXEL = 9
"""More than the pixels of any PNG take, uncompressed: four channels of 16 bits, and its filters."""
_PNG_KIND = struct.Struct(">BB")
_PNG_KIND_AT = 24
_GREY_16 = (16, 0)
_GREYS = 65_536
_UNDECODABLE = (OSError, SyntaxError, ValueError, struct.error, EOFError, zlib.error)
"""What Pillow raises for broken images."""


@dataclass(frozen=True, eq=False)
class PackedObservation:
    """An observation whose images are still encoded.

    Attributes:
        header: Facts, and formats of the images.
        colour: Encoded colour image.
        depth: Encoded depth image.
        labels: Encoded labels; None unless the header has them.
    """

    header: ObservationHeader
    colour: bytes
    depth: bytes
    labels: bytes | None


def pack_observation(
    facts: ObservationFacts,
    rgb: UInt8[np.ndarray, "height width 3"],
    depth: Float32[np.ndarray, "height width"],
    truth: LabelledPixels | None = None,
    *,
    jpeg_quality: int | None = 90,
    raw_depth: bool = False,
) -> bytes:
    """The bytes of an observation.

    Args:
        facts: Number, time and poses.
        rgb: Colour image.
        depth: Depth image, metres; what is not positive and finite is sent as no return.
        truth: True labels, in simulation only.
        jpeg_quality: Quality of the colour image as JPEG; None sends a PNG.
        raw_depth: Whether to send depth as float32 instead of whole millimetres.
    """
    colour = _jpeg(rgb, jpeg_quality) if jpeg_quality is not None else _png(Image.fromarray(rgb))
    metres = np.where(np.isfinite(depth) & (depth > 0.0), depth, np.float32(0.0))
    if raw_depth:
        far = metres.astype("<f4").tobytes()
    else:
        millimetres = np.clip(np.rint(metres * _MILLIMETRES), 0, _FARTHEST_MM)
        far = _png(Image.fromarray(millimetres.astype(np.uint16)))
    labels, names = b"", None
    if truth is not None:
        labels = _png(Image.fromarray((truth.ids + 1).astype(np.uint16)))
        shown = {int(number) for number in np.unique(truth.ids)} - {-1}
        names = {number: truth.labels[number] for number in shown if number in truth.labels}
    header = ObservationHeader(
        **{name: getattr(facts, name) for name in ObservationFacts.model_fields},
        colour=ColourPart(format="png" if jpeg_quality is None else "jpeg", bytes=len(colour)),
        depth=DepthPart(format="float32" if raw_depth else "png-mm", bytes=len(far)),
        labels=None if names is None else LabelsPart(bytes=len(labels), names=names),
    )
    line = header.model_dump_json(exclude_defaults=True).encode()
    return line + b"\n" + colour + far + labels


def unpack_observation(body: bytes) -> PackedObservation:
    """Read the header and cut the body into its images; nothing is decompressed.

    Raises:
        WireError: The body does not follow the contract.
    """
    if len(body) > MOST_BODY_BYTES:
        raise WireError(
            f"an observation has at most {MOST_BODY_BYTES:,} bytes, got {len(body):,}; send JPEG "
            "and 16-bit PNG, or smaller images"
        )
    end = body.find(b"\n", 0, MOST_HEADER_BYTES)
    if end < 0:
        raise WireError(
            "an observation begins with one line of JSON, ended by a line feed within the first "
            f"{MOST_HEADER_BYTES:,} bytes; found none"
        )
    try:
        header = ObservationHeader.model_validate_json(body[:end])
    except ValidationError as error:
        raise WireError(f"the observation's header: {first_mistake(error)}") from error
    if (key := repeated_key(body[:end])) is not None:
        raise WireError(f"the observation's header has the key {key[:80]!a} twice")
    parts = [header.colour, header.depth] + ([header.labels] if header.labels else [])
    announced = sum(part.bytes for part in parts)
    if announced != len(body) - end - 1:
        raise WireError(
            f"the header announces {announced:,} bytes of images, {len(body) - end - 1:,} follow it"
        )
    images, at = [], end + 1
    for part in parts:
        images.append(body[at : at + part.bytes])
        at += part.bytes
    return PackedObservation(header, images[0], images[1], images[2] if header.labels else None)


def decode_observation(
    packed: PackedObservation,
    camera: PinholeCamera,
    camera_to_base: Transform,
    robot_to_map: Transform | None = None,
) -> Observation:
    """The observation as an agent takes it.

    Args:
        packed: Observation with encoded images.
        camera: Camera model of the search, whose size the images must have.
        camera_to_base: Pose of the camera on the robot, unless the observation has its own.
        robot_to_map: Transform from the frame of the robot's poses to the ``map`` frame of the
            search; None if that is the same.

    Raises:
        WireError: An image is broken, or of another size or format than announced; or the robot is
            said to be farther away than a map reaches.
    """
    header = packed.header
    base_to_map = header.base_to_map
    if robot_to_map is not None:
        base_to_map = robot_to_map @ base_to_map
    x, y, _ = base_to_map.translation
    if max(abs(x), abs(y)) > MAP_REACH_M:
        raise WireError(
            f"the robot would be at ({x:.1f}, {y:.1f}) m, but a map reaches {MAP_REACH_M:g} m from "
            "its origin; is a pose wrong, or must odom_to_map move the origin to where it starts?"
        )
    camera_to_base = header.camera_pose(camera_to_base)
    return Observation(
        rgb=_decoded_colour(packed, camera),
        depth=_decoded_depth(packed, camera),
        camera=camera,
        camera_to_map=base_to_map @ camera_to_base,
        robot=Pose2(float(x), float(y), base_to_map.yaw),
        truth=_decoded_labels(packed, camera),
    )


def first_mistake(error: ValidationError) -> str:
    """The first error of a message, in one line that quotes only a little of it."""
    first = error.errors(include_url=False, include_input=False)[0]
    where = ".".join(str(part) for part in first["loc"])
    return f"{where[:100]}: {first['msg'][:300]}" if where else first["msg"][:300]


def _decoded_colour(
    packed: PackedObservation, camera: PinholeCamera
) -> UInt8[np.ndarray, "height width 3"]:
    kind = packed.header.colour.format
    _check_size(packed.colour, camera, f"the colour image ({kind})")
    image = _opened(packed.colour, kind.upper(), "the colour image")
    try:
        return np.asarray(image.convert("RGB"))
    except _UNDECODABLE as error:
        raise WireError(f"the colour image is broken: {error!s:.100}") from error


def _decoded_depth(
    packed: PackedObservation, camera: PinholeCamera
) -> Float32[np.ndarray, "height width"]:
    size = (camera.height, camera.width)
    if packed.header.depth.format == "png-mm":
        millimetres = _decoded_grey(packed.depth, camera, "the depth image")
        return millimetres.astype(np.float32) / np.float32(_MILLIMETRES)
    expected = 4 * camera.width * camera.height
    if len(packed.depth) != expected:
        raise WireError(
            f"the depth image (float32) of {camera.width} × {camera.height} pixels has "
            f"{expected:,} bytes, got {len(packed.depth):,}"
        )
    metres = np.frombuffer(packed.depth, dtype="<f4").reshape(size)
    return np.where(np.isfinite(metres) & (metres > 0.0), metres, np.float32(0.0))


def _decoded_labels(packed: PackedObservation, camera: PinholeCamera) -> LabelledPixels | None:
    if packed.labels is None or packed.header.labels is None:
        return None
    numbers = _decoded_grey(packed.labels, camera, "the image of labels")
    names = packed.header.labels.names
    ids = np.full(_GREYS, -1, dtype=np.int32)  # pixels without a named instance
    for number in names:
        ids[number + 1] = number
    return LabelledPixels(ids[numbers], names)


def _decoded_grey(
    data: bytes, camera: PinholeCamera, what: str
) -> UInt16[np.ndarray, "height width"]:
    _check_size(data, camera, what)
    kind = _PNG_KIND.unpack_from(data, _PNG_KIND_AT) if len(data) > _PNG_KIND_AT + 2 else None
    if kind != _GREY_16:
        raise WireError(
            f"{what} must be a PNG with one channel of 16 bits, got (bits, colour type) {kind}"
        )
    image = _opened(data, "PNG", what)
    try:
        image.load()
    except _UNDECODABLE as error:
        raise WireError(f"{what} is broken: {error!s:.100}") from error
    return np.asarray(image).astype(np.uint16)


def _opened(data: bytes, kind: str, what: str) -> Image.Image:
    try:
        return Image.open(io.BytesIO(data), formats=[kind])
    except _UNDECODABLE as error:
        raise WireError(f"{what} is not a {kind} that can be read") from error


def _check_size(data: bytes, camera: PinholeCamera, what: str) -> None:
    size = image_size(data)
    if size is None:
        raise WireError(f"{what} is neither a PNG nor a JPEG that can be read")
    if size != (camera.width, camera.height):
        raise WireError(
            f"{what} has {size[0]} × {size[1]} pixels; the search was opened for "
            f"{camera.width} × {camera.height}"
        )
    if data.startswith(_PNG):
        _check_content(data, camera, what)


def _check_content(data: bytes, camera: PinholeCamera, what: str) -> None:
    """Refuse a PNG that holds more than its pixels; this ends as soon as that is known."""
    most = _MOST_BYTES_A_PIXEL * (camera.width + 1) * camera.height
    at, left, inflating = len(_PNG), most, zlib.decompressobj()
    try:
        while at + 8 <= len(data) and left > 0:
            (length,), name = struct.unpack_from(">I", data, at), data[at + 4 : at + 8]
            if name == b"IEND":
                return
            if name == b"IDAT":
                left -= len(inflating.decompress(data[at + 8 : at + 8 + length], left))
            at += length + 12
    except zlib.error as error:
        raise WireError(f"{what} is broken: {error!s:.100}") from error
    if left <= 0:
        raise WireError(
            f"{what} holds more than the {camera.width} × {camera.height} pixels that it announces"
        )


def _jpeg(rgb: UInt8[np.ndarray, "height width 3"], quality: int) -> bytes:
    encoded = io.BytesIO()
    Image.fromarray(rgb).save(encoded, "JPEG", quality=quality)
    return encoded.getvalue()


def _png(image: Image.Image) -> bytes:
    encoded = io.BytesIO()
    image.save(encoded, "PNG", compress_level=1)
    return encoded.getvalue()
