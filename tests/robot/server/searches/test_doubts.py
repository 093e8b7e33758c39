"""Plausible but misread input of a robot is said, with the evidence; right input is not."""

import json
import math
from collections.abc import Callable, Iterator

import numpy as np
import pytest

from box_views import room, view_of
from hypernav.core.embodiment import Action
from hypernav.core.geometry.camera import PinholeCamera, optical_to_base
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.observation import Observation
from hypernav.robot.server.searches.doubts import Doubts
from hypernav.robot.wire.frames import pack_observation
from hypernav.robot.wire.requests import ObservationFacts
from hypernav.robot.wire.values import PlanarPose
from hypernav.simulator.worlds.box_room import BoxRoom
from servers.robots import RobotLink, real_plan, robot_server

CAMERA = PinholeCamera.from_hfov(80, 60, 79.0)
MOUNT = optical_to_base(0.9, 5.0)
TURN = math.radians(30.0)
ROOM = [
    *room(4.5, 4.0),
    ((3.6, 0.2, 0.0), (4.3, 1.4, 0.7)),
    ((0.3, 3.0, 0.0), (0.9, 3.8, 1.8)),
    ((2.2, 3.5, 0.0), (3.2, 3.9, 0.9)),
    ((0.1, 0.2, 0.0), (0.5, 1.0, 2.0)),
]
HEADINGS = [*(number * TURN for number in range(13)), *([0.0, 0.0, -TURN, -TURN] * 2)]


def views() -> Iterator[tuple[float, Observation]]:
    """A look around in a brown room, and then turns with pauses between them."""
    noise = np.random.default_rng(0)
    yaw = 0.0
    for number, heading in enumerate(HEADINGS):
        yaw = heading if number < 13 else yaw + heading
        seen = view_of(ROOM, Pose2(2.0, 1.8, yaw), camera=CAMERA, height_m=0.9, pitch_deg=5.0)
        points = seen.camera_to_map.apply(CAMERA.rays() * seen.depth[..., None].astype(np.float64))
        wood = 90.0 + 50.0 * np.sin(3.0 * points[..., 0]) * np.cos(4.0 * points[..., 1])
        shade = (wood + noise.normal(0.0, 4.0, wood.shape))[..., None] * (1.5, 1.0, 0.5)
        depth = seen.depth * noise.normal(1.0, 0.005, seen.depth.shape).astype(np.float32)
        rgb = np.clip(shade, 0.0, 255.0).astype(np.uint8)
        yield yaw, Observation(rgb, depth, CAMERA, seen.camera_to_map, seen.robot, None)


VIEWS = list(views())


def doubts(
    *,
    rgb: Callable[[np.ndarray], np.ndarray] = lambda image: image,
    depth: Callable[[np.ndarray], np.ndarray] = lambda image: image,
    camera: PinholeCamera = CAMERA,
    mount: Transform = MOUNT,
    late: int = 0,
) -> list[str]:
    """What is said about the room if its images, lens or poses are changed."""
    found, said = Doubts(camera, MOUNT), list[str]()
    rows = tuple(tuple(row) for row in mount.matrix.tolist())
    for number, (yaw, _) in enumerate(VIEWS if late else VIEWS[:13]):
        seen = VIEWS[max(number - late, 0)][1]
        facts = ObservationFacts.model_validate(
            {"sequence": number, "stamp_s": number, "camera_to_base": rows}
            | {"base_to_odom": PlanarPose(x=7.0, y=-3.0, yaw=yaw)}
        )
        colours, metres = (np.ascontiguousarray(one) for one in (rgb(seen.rgb), depth(seen.depth)))
        to_map = seen.robot.to_transform() @ mount
        view = Observation(colours, metres, camera, to_map, seen.robot, None)
        said += found.look(facts, view)
    return said


def test_nothing_is_said_of_what_is_right():
    assert doubts() == []


def test_nothing_is_said_of_a_tilt_that_is_wrong_by_two_degrees():
    assert doubts(mount=optical_to_base(0.9, 7.0)) == []


@pytest.mark.parametrize("factor", [10.0, 5.0, 4.0, 0.25, 0.1])
def test_depth_in_another_unit_is_said(factor):
    (words,) = doubts(depth=lambda image: image * np.float32(factor))
    said = float(words.split(" is ")[1].split(" times")[0])
    assert said == factor
    assert "in another unit (png-mm and 16UC1 count millimetres" in words


def test_a_height_that_is_wrong_is_no_unit():
    (words,) = doubts(mount=optical_to_base(0.55, 5.0))
    assert "is 1.6 times as far away as it is for a camera 0.55 m above it" in words
    assert "unit" not in words


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        (np.diag([1.0, -1.0, -1.0]), "OpenGL"),
        (optical_to_base(0.0).rotation.T, "that of a body"),
        (np.diag([-1.0, -1.0, 1.0]), "upside down"),
    ],
)
def test_a_pose_in_another_convention_is_said(changed, words):
    (said,) = doubts(mount=Transform(MOUNT.rotation @ changed, MOUNT.translation))
    assert words in said


@pytest.mark.parametrize(("quarters", "side"), [(1, "left"), (-1, "right")])
def test_a_camera_on_its_side_is_said(quarters, side):
    lens = PinholeCamera(60, 80, CAMERA.fx, CAMERA.fy, 30.0, 40.0)

    def turned(image: np.ndarray) -> np.ndarray:
        return np.rot90(image, quarters)

    (words,) = doubts(rgb=turned, depth=turned, camera=lens)
    assert f"by 90° to the {side}" in words


@pytest.mark.parametrize("share", [0.5, 2.0])
def test_the_calibration_of_another_resolution_is_said_at_once(share):
    lens = PinholeCamera(80, 60, *(share * value for value in CAMERA.lens))
    words, *_ = doubts(camera=lens)
    assert "principal point" in words
    assert "80 × 60 pixels; are fx, fy, cx and cy those of this size?" in words


def test_focal_lengths_of_another_camera_are_said():
    lens = PinholeCamera(80, 60, 1.6 * CAMERA.fx, 1.6 * CAMERA.fy, 40.0, 30.0)
    (words,) = doubts(camera=lens)
    assert "fx and fy" in words


def mirrored(image: np.ndarray) -> np.ndarray:
    return image[:, ::-1]


@pytest.mark.parametrize(
    ("changes", "names"),
    [
        ({"rgb": mirrored, "depth": mirrored}, "colour and depth"),
        ({"rgb": mirrored}, "colour"),
        ({"depth": mirrored}, "depth"),
    ],
)
def test_mirrored_images_are_said(changes, names):
    (words,) = doubts(**changes)
    assert words.startswith(f"the {names} images turn the other way")


def test_images_that_are_one_observation_old_are_said():
    (words,) = doubts(late=1)
    assert "images turn one observation later than the poses" in words


def test_images_that_never_change_but_for_noise_are_said():
    noise = np.random.default_rng(1)
    first = VIEWS[3][1]
    (words,) = doubts(
        rgb=lambda _: first.rgb + noise.integers(0, 3, first.rgb.shape, dtype=np.uint8),
        depth=lambda _: first.depth * noise.normal(1.0, 0.01, first.depth.shape).astype(np.float32),
    )
    assert "don't turn when the poses do" in words


def test_red_and_blue_that_are_exchanged_are_said():
    (words,) = doubts(rgb=lambda image: image[..., ::-1])
    assert "are red and blue exchanged (OpenCV's arrays are BGR" in words


def test_images_without_any_depth_or_colour_are_no_doubt():
    assert doubts(rgb=np.zeros_like, depth=np.zeros_like) == []


def told(link: RobotLink, factor: float) -> tuple[str, list[str], list[str]]:
    """A search in whose depth one unit counts so many millimetres: path, reasons and events."""
    search, room, reasons = link.open(), BoxRoom(), list[str]()
    for sequence in range(13):
        seen = room.observe()
        pose = PlanarPose(x=seen.robot.x, y=seen.robot.y, yaw=seen.robot.yaw)
        facts = ObservationFacts(sequence=sequence, stamp_s=0.5 * sequence, base_to_odom=pose)
        depth = seen.depth * np.float32(factor)
        reply = link.observe(search, pack_observation(facts, seen.rgb, depth, seen.truth)).json
        reply = link.answer(search, sequence) if reply["hold"] else reply
        reasons.append(reply["reason"])
        if reply["done"]:
            break
        room.step(Action(reply["action"]))
    trace = link.call("GET", f"{search}/trace").content.decode().splitlines()
    return search, reasons, [event for line in trace for event in json.loads(line)["events"]]


def test_robot_and_operator_read_the_doubt_once(tmp_path, caplog):
    with robot_server(tmp_path, real_plan) as link:
        search, reasons, events = told(link, 4.0)
        right_search, right, _ = told(link, 1.0)
        assert link.call("GET", right_search).json["doubts"] == []
    words = "4 times as far away as it is for a camera 0.88 m above it; is depth in another unit"
    assert sum(words in event for event in events) == 1
    assert sum("Check what the robot sends: the floor" in reason for reason in reasons) == 1
    assert words in caplog.text
    assert not any("Check what the robot sends" in reason for reason in right)
    with robot_server(tmp_path, real_plan) as link:
        (doubt,) = link.call("GET", search).json["doubts"]
    assert words in doubt
