from bisect import bisect_right
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import av
import cv2
import numpy as np
import pytest

from certainty import certain
from hypernav.app.show import episode_video
from hypernav.app.show.climbs import climbs, stairs_on
from hypernav.app.show.episode_video import EpisodeVideo
from hypernav.app.show.video_frame import (
    ENDING_FRAMES,
    FRAMES_PER_SECOND,
    MAP_SIZE,
    draw_camera,
    frame_count,
    start_times,
)
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.observation import Observation
from hypernav.core.trace import DetectionRecord, Mode, StepTrace
from hypernav.search.drawing import palette

MakeStep = Callable[..., StepTrace]


class Film(NamedTuple):
    codec: av.VideoCodecContext
    length_s: float
    images: list[np.ndarray]
    times: list[float]

    def at(self, time: float) -> np.ndarray:
        """What a player shows at a time."""
        return self.images[bisect_right(self.times, time + 1e-6) - 1]

    @property
    def frames(self) -> int:
        return round(self.length_s * FRAMES_PER_SECOND)


def read(path: Path) -> Film:
    with av.open(str(path)) as container:
        stream = container.streams.video[0]
        frames = list(container.decode(stream))
        return Film(
            codec=stream.codec_context,
            length_s=float(certain(stream.duration) * certain(stream.time_base)),
            images=[frame.to_ndarray(format="rgb24") for frame in frames],
            times=[frame.time for frame in frames],
        )


def film(
    path: Path,
    steps: list[StepTrace],
    observation: Observation,
    grid: OccupancyGrid,
    result: dict[str, Any] | None,
    goal: str = "bed",
) -> Path:
    with EpisodeVideo(path, goal, "hypernav", detector="ground truth", step_limit=500) as video:
        for step in steps:
            video.add(observation.rgb, step, grid)
        if result is not None:
            video.finish(result)
    return path


def test_the_video_is_what_browsers_play(
    make_step: MakeStep,
    observation: Observation,
    room: OccupancyGrid,
    result: dict[str, Any],
    tmp_path: Path,
) -> None:
    steps = [make_step(n) for n in range(7)]
    path = film(tmp_path / "new" / "episode.mp4", steps, observation, room, result)
    video = read(path)
    assert (video.codec.name, video.codec.pix_fmt) == ("h264", "yuv420p")
    assert video.frames == sum(frame_count(step) for step in steps) + ENDING_FRAMES
    assert video.times[: len(steps)] == pytest.approx(
        start_times([frame_count(step) for step in steps]), abs=1e-3
    )
    assert all(image.shape == (720, 1280, 3) for image in video.images)
    content = path.read_bytes()
    assert content.index(b"moov") < content.index(b"mdat"), "the index comes first"


def test_times_in_the_video_are_those_that_the_page_seeks_to(
    make_step: MakeStep, observation: Observation, room: OccupancyGrid, tmp_path: Path
) -> None:
    modes = [Mode.LOOK_AROUND, Mode.EXPLORE, Mode.EXPLORE, Mode.APPROACH, Mode.STOP]
    steps = [make_step(n, mode=mode) for n, mode in enumerate(modes)]
    video = read(film(tmp_path / "episode.mp4", steps, observation, room, None))
    times = start_times([frame_count(step) for step in steps])
    assert times == sorted(times)
    assert video.frames == sum(frame_count(step) for step in steps)
    for mode, time in zip(modes, times, strict=True):
        chip = video.at(time)[16:30, 690:698].reshape(-1, 3)
        assert np.median(chip, axis=0) == pytest.approx(np.array(palette.MODES[mode]), abs=14)


def test_decisions_and_events_stay_longer(make_step: MakeStep) -> None:
    plain, asked, event = make_step(0), make_step(2), make_step(0, events=["goal seen"])
    assert frame_count(asked) > frame_count(plain)
    assert frame_count(event) > frame_count(plain)
    only_looked = make_step(0, exchanges=[make_step(2).exchanges[0]])
    assert frame_count(only_looked) == frame_count(plain), "asked at every step, so nothing special"
    assert start_times([]) == []


def test_a_step_that_is_passed_over_shows_in_the_next_ones_trajectory_and_decision(
    make_step: MakeStep, observation: Observation, room: OccupancyGrid, tmp_path: Path
) -> None:
    steps = [make_step(number) for number in range(5)]  # the third asks a question
    shown, every = tmp_path / "shown.mp4", tmp_path / "every.mp4"
    film(every, steps, observation, room, None)
    with EpisodeVideo(shown, "bed", "hypernav", detector="ground truth", step_limit=500) as video:
        for step in steps[:3]:
            video.pass_over(step)
        for step in steps[3:]:
            video.add(observation.rgb, step, room)
        assert video.frame_counts == [0, 0, 0, *map(frame_count, steps[3:])]
    assert start_times([0, 0, 0, 1, 6]) == [0.0, 0.0, 0.0, 0.0, 1 / FRAMES_PER_SECOND]
    # In means over 4 x 4 pixels compression leaves thin lines alike, whatever frames came before.
    last, expected = (
        cv2.resize(read(path).images[-1], None, fx=0.25, fy=0.25, interpolation=cv2.INTER_AREA)
        for path in (shown, every)
    )
    assert (np.abs(last.astype(int) - expected) > 40).mean() < 0.001


def test_an_interrupted_film_plays_up_to_its_last_step(
    make_step: MakeStep, observation: Observation, room: OccupancyGrid, tmp_path: Path
) -> None:
    path = tmp_path / "episode.mp4"

    def interrupted() -> None:
        with EpisodeVideo(path, "bed", "hypernav") as video:
            for number in range(2):
                video.add(observation.rgb, make_step(number), room)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert read(path).frames == 2


def test_a_film_without_a_step_opens(result: dict[str, Any], tmp_path: Path) -> None:
    with EpisodeVideo(tmp_path / "nothing.mp4", "bed", "hypernav"):
        pass
    assert read(tmp_path / "nothing.mp4").frames == 1
    with EpisodeVideo(tmp_path / "card.mp4", "bed", "hypernav") as video:
        video.finish(result)
        video.close()
        video.close()
    assert read(tmp_path / "card.mp4").frames == ENDING_FRAMES


@pytest.mark.parametrize(
    "text",
    ["the L-shaped sofa next to the window in the big office " * 20, "椅子 🛋️\nżółw", "\x00<b>"],
)
def test_any_text_fits_into_the_frame(
    text: str,
    make_step: MakeStep,
    observation: Observation,
    room: OccupancyGrid,
    sighting: DetectionRecord,
    tmp_path: Path,
) -> None:
    asked = make_step(2)
    exchanges = [
        exchange.model_copy(
            update={"question": text * 30, "answer": text, "probabilities": {text: 1.0, "b": 0.0}}
        )
        for exchange in asked.exchanges
    ]
    detections = [sighting.model_copy(update={"label": text, "accepted": False, "reason": text})]
    step = make_step(2, reason=text, exchanges=exchanges, detections=detections)
    path = film(tmp_path / "a.mp4", [step], observation, room, {"outcome": "not_found"}, goal=text)
    assert read(path).frames == frame_count(step) + ENDING_FRAMES


def test_an_accepted_detection_is_outlined_where_it_is(sighting: DetectionRecord) -> None:
    rgb = np.full((120, 160, 3), 130, dtype=np.uint8)
    panel = draw_camera(rgb, [sighting], width=640, height=480)
    for u, v in ((40, 55), (90, 55), (65, 80)):
        assert tuple(panel[v * 4, u * 4]) == palette.GOAL
    assert (panel[40:100, 20:100] == 130).all()
    assert (rgb == 130).all(), "the observation stays as it was"


@pytest.mark.parametrize(("width", "height"), [(640, 480), (1280, 720), (480, 640), (7, 5)])
def test_images_of_any_shape_fit_into_the_panel(
    width: int, height: int, sighting: DetectionRecord
) -> None:
    rgb = np.full((height, width, 3), 200, dtype=np.uint8)
    panel = draw_camera(rgb, [sighting], width=640, height=480)
    assert panel.shape == (480, 640, 3)
    shown = (panel == 200).all(axis=2)
    assert shown[240, 320] or shown[60, 320] or shown[400, 500]


def test_a_camera_of_another_size_can_be_filmed(
    make_step: MakeStep, room: OccupancyGrid, tmp_path: Path
) -> None:
    wide = Observation(
        rgb=np.zeros((90, 320, 3), dtype=np.uint8),
        depth=np.zeros((90, 320), dtype=np.float32),
        camera=PinholeCamera.from_hfov(320, 90, 100.0),
        camera_to_map=Transform.identity(),
        robot=Pose2(0.0, 0.0, 0.0),
    )
    assert read(film(tmp_path / "w.mp4", [make_step(0)], wide, room, None)).frames == 1


def test_stairs_are_told_from_the_steps_anew_only_when_one_is_on_them(
    make_step: MakeStep,
    observation: Observation,
    room: OccupancyGrid,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    e, c = Mode.EXPLORE, Mode.CLIMB
    modes, floors = [e, e, e, c, c, e, e, c, e, e], [None] * 5 + [2] * 5
    steps = [
        make_step(k, mode=mode, floor=floor, pose=(0.3 * k, 0.0, 0.0))
        for k, (mode, floor) in enumerate(zip(modes, floors, strict=True))
    ]
    told = list[int]()
    shown = list[object]()
    monkeypatch.setattr(
        episode_video, "climbs", lambda walk: told.append(len(walk) - 1) or climbs(walk)
    )
    monkeypatch.setattr(
        episode_video,
        "stairs_on",
        lambda floor, made: shown.append(stairs_on(floor, made)) or stairs_on(floor, made),
    )
    film(tmp_path / "episode.mp4", steps, observation, room, None)
    assert told == [3, 4, 5, 7, 8]
    assert shown == [
        stairs_on(floor or 1, climbs(steps[: k + 1])) for k, floor in enumerate(floors)
    ]


def test_the_map_says_how_high_its_floor_is_and_when_the_robot_is_on_stairs(
    make_step: MakeStep,
    observation: Observation,
    room: OccupancyGrid,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    titles = list[str]()

    def note(*_: object, title: str, **__: object) -> np.ndarray:
        titles.append(title)
        return np.zeros((MAP_SIZE, MAP_SIZE, 3), np.uint8)

    monkeypatch.setattr(episode_video, "draw_map", note)
    walk = [
        (Mode.EXPLORE, None, 0.0),
        (Mode.CLIMB, None, 0.0),
        (Mode.CLIMB, None, 1.2),
        (Mode.CLIMB, None, -0.5),
        (Mode.EXPLORE, 2, 3.0),
    ]
    with EpisodeVideo(tmp_path / "episode.mp4", "bed", "hypernav") as video:
        for number, (mode, floor, z) in enumerate(walk):
            step = make_step(number, mode=mode, floor=floor, z=z)
            video.add(observation.rgb, step, room)
    assert titles == [
        "",
        "Floor 1 (start), robot on the stairs",
        "Floor 1 (start), robot on the stairs, 1.2 m up",
        "Floor 1 (start), robot on the stairs, 0.5 m down",
        "Floor 2 (3.0 m above the start)",
    ]
