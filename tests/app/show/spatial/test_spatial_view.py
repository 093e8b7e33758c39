"""The view in three dimensions: its content, and the page in a browser."""

import base64
import gzip
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from selenium import webdriver
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import WebDriverWait

from browsers import chromium
from hypernav.app.show.episode_page import write_page
from hypernav.app.show.spatial import view as view_module
from hypernav.app.show.spatial.cloud import ColouredCloud
from hypernav.app.show.spatial.view import camera_frame, library, packed_cloud, search_view
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.geometry.transforms import Pose2
from hypernav.core.observation import Observation
from hypernav.core.trace import Ending, Mode, StepTrace

MakeStep = Callable[..., StepTrace]
THREE = Path(view_module.__file__).parent / "three"


def _cloud(observation: Observation, floors: int = 1) -> ColouredCloud:
    cloud = ColouredCloud()
    for floor in range(1, floors + 1):
        cloud.add(
            observation.rgb,
            observation.depth,
            observation.camera,
            Pose2(0.0, 0.0, 0.0).to_transform(2.8 * (floor - 1)) @ observation.camera_to_map,
            floor=floor,
        )
    return cloud


def test_three_js_travels_unedited_with_its_licence() -> None:
    assert "MIT" in (THREE / "LICENSE").read_text()
    assert "0.170.0" in (THREE / "README.md").read_text()
    source = (THREE / "three.module.min.js").read_bytes()
    assert b'="170"' in source
    assert gzip.decompress(base64.b64decode(library()["three"])) == source


def test_a_packed_cloud_holds_every_point_and_its_colour(observation: Observation) -> None:
    cloud = _cloud(observation, floors=2)
    packed = packed_cloud(cloud)
    numbers = np.frombuffer(gzip.decompress(base64.b64decode(packed["numbers"])), "<u2")
    x, y, z, colours = numbers.reshape(4, -1)
    read = np.stack([np.cumsum(one.astype(np.int16), dtype=np.int16) for one in (x, y, z)], axis=1)
    expected = np.concatenate([cells for cells, _ in cloud.points().values()])
    assert (read == expected).all()
    assert packed["counts"] == {floor: len(one[0]) for floor, one in cloud.points().items()}
    assert set(colours.tolist()) == {(130 >> 3) << 11 | (130 >> 2) << 5 | 130 >> 3}


def test_a_camera_frame_lies_in_front_of_the_camera(observation: Observation) -> None:
    eye, *corners = camera_frame(observation.camera, observation.camera_to_map)
    assert eye == pytest.approx([0.0, 0.0, 0.88])
    assert all(x > 0.5 for x, _, _ in corners)
    (_, left, top), (_, right, _), (_, _, bottom), _ = corners
    assert left > 0.0 > right
    assert top > 0.88 > bottom


def test_the_last_area_is_the_goal_only_if_the_search_ended_there(
    make_step: MakeStep, room: OccupancyGrid
) -> None:
    area = {"goal_area": [[(1.0, 0.0), (1.5, 0.0), (1.5, 0.5)]]}
    steps = [make_step(0), make_step(1, **area), make_step(2), make_step(3, **area)]
    for ending, colors in (
        (Ending.FOUND, ["--bad", "--good"]),
        (Ending.GAVE_UP, ["--bad", "--bad"]),
    ):
        steps[-1] = make_step(3, **area, ending=ending)
        view = search_view(steps, {1: room}, None, [])
        assert view is not None
        assert [mark["color"] for mark in view["marks"]] == colors


def test_the_path_is_whole_and_coloured_by_what_the_robot_did(
    make_step: MakeStep, room: OccupancyGrid
) -> None:
    modes = [Mode.EXPLORE, Mode.EXPLORE, Mode.EXPLORE, Mode.APPROACH, Mode.APPROACH]
    view = search_view([make_step(n, mode=m) for n, m in enumerate(modes)], {1: room}, None, [])
    assert view is not None
    explored, approached = view["paths"]
    assert (explored["color"], approached["color"]) == ("--mode-explore", "--mode-approach")
    assert explored["points"][-1] == approached["points"][0]


def test_a_search_without_a_map_has_no_view(make_step: MakeStep) -> None:
    assert search_view([make_step(0)], {}, None, []) is None
    assert search_view([], {}, None, []) is None


@pytest.fixture(scope="module")
def browser() -> Iterator[webdriver.Chrome]:
    with chromium("--enable-unsafe-swiftshader", "--use-angle=swiftshader") as browser:
        browser.set_window_size(800, 600)
        browser.set_script_timeout(300)
        yield browser


@pytest.mark.slow
def test_the_building_is_drawn_offline_and_turns(
    browser: webdriver.Chrome,
    make_step: MakeStep,
    room: OccupancyGrid,
    result: dict[str, Any],
    observation: Observation,
    tmp_path: Path,
) -> None:
    steps = [make_step(n, floor=1 + n // 4, z=2.8 * (n // 4)) for n in range(12)]
    maps = dict.fromkeys(range(1, 4), room)
    page = write_page(tmp_path, result, steps, maps, cloud=_cloud(observation, floors=3))
    assert page.stat().st_size < 5_000_000
    browser.get(page.as_uri())
    browser.execute_script("document.getElementById('stage').scrollIntoView()")
    space = browser.find_element(By.ID, "space")
    WebDriverWait(browser, 60).until(lambda _: space.get_attribute("data-state"))
    assert space.get_attribute("data-state") == "drawn"
    canvas = browser.find_element(By.CSS_SELECTOR, "#stage canvas")
    stage = browser.find_element(By.ID, "stage")

    def settled() -> bytes:
        browser.execute_async_script("requestAnimationFrame(() => setTimeout(arguments[0], 300))")
        return canvas.screenshot_as_png

    seen = settled()
    stage.send_keys("\ue012")  # the left arrow key
    turned = settled()
    assert turned != seen
    browser.find_element(By.CSS_SELECTOR, "[data-show='2']").click()
    assert settled() != turned
    assert [one for one in browser.get_log("browser") if one["level"] == "SEVERE"] == []
