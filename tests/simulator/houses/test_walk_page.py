"""The walk through a building on its page: positions, panoramas, what is said, and the browser."""

import base64
import io
import json
import math
import os
import re
import shutil
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from selenium import webdriver
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

from hypernav.core.embodiment import CameraConfig
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2
from hypernav.simulator.houses.building import BUILTIN_HOUSE, Building, house
from hypernav.simulator.houses.export import building_page as page_module
from hypernav.simulator.houses.export.building_page import building_page
from hypernav.simulator.houses.export.building_views import camera_pose
from hypernav.simulator.houses.export.walk import (
    SLICES,
    Panorama,
    WalkGraph,
    draw_panorama,
    slice_camera,
    walk_graph,
)
from hypernav.simulator.houses.generator import generate, plan_of
from hypernav.simulator.houses.plan.floor_plan import FloorPlan
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer
from hypernav.simulator.worlds.scenes.scene import Scene
from hypernav.simulator.worlds.surface.walkable import WalkableGrid

BUILDING = house(BUILTIN_HOUSE)


@pytest.fixture(scope="module")
def grid(builtin_scene: Scene) -> WalkableGrid:
    return WalkableGrid.from_scene(builtin_scene)


@pytest.fixture(scope="module")
def renderer(builtin_scene: Scene) -> Iterator[CpuRenderer]:
    with closing(CpuRenderer(builtin_scene)) as renderer:
        yield renderer


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return building_page(BUILDING, tmp_path_factory.mktemp("page"))


@pytest.fixture(scope="module")
def walk(page: Path) -> dict[str, Any]:
    found = re.search(
        r'<script type="application/json" id="places">(.*?)</script>', page.read_text()
    )
    assert found is not None
    return json.loads(found[1])


def _reached(graph: WalkGraph) -> set[int]:
    reached, ahead = {0}, [0]
    while ahead:
        new = set(graph.neighbours[ahead.pop()]) - reached
        reached |= new
        ahead += new
    return reached


@pytest.mark.parametrize(
    "name",
    [
        "houses:0",
        *(pytest.param(name, marks=pytest.mark.slow) for name in ("houses:12", "offices:7")),
    ],
)
def test_every_position_is_reached_by_straight_drives_there_and_back(name):
    building = Building.named(name)
    grid, plan = WalkableGrid.from_scene(generate(building)), plan_of(building)
    graph = walk_graph(grid, plan)
    assert all(grid.component_of(*point) == 0 for point in graph.positions)
    assert _reached(graph) == set(range(len(graph.positions)))
    for a, neighbours in enumerate(graph.neighbours):
        for b in neighbours:
            (x, y), end = graph.positions[a], graph.positions[b]
            assert math.dist(grid.step(x, y, end[0] - x, end[1] - y), end) < grid.cell_m
            assert a in graph.neighbours[b]
    for room in plan.rooms:
        if any(_is_in(room.inner, point) for point in grid.centres()[::7]):
            assert any(_is_in(room.cell, point) for point in graph.positions), room.name
    assert walk_graph(grid, plan) == graph


def _is_in(rect: Any, point: Any) -> bool:
    return bool(rect.x0 <= point[0] <= rect.x1 and rect.y0 <= point[1] <= rect.y1)


def test_two_halves_of_a_room_joined_by_a_bend_are_one_walk():
    free = np.zeros((80, 80), dtype=bool)
    free[5:75, 5:15] = free[5:15, 5:75] = free[5:75, 65:75] = True
    grid = WalkableGrid.from_mask(free)
    graph = walk_graph(grid, FloorPlan((), ()))
    assert len(graph.positions) > 2
    assert _reached(graph) == set(range(len(graph.positions)))


def _looked_up(
    panorama: Panorama, camera: PinholeCamera, yaw: float
) -> tuple[np.ndarray, np.ndarray]:
    """Colours and instances that a camera sees in this direction, taken from the panorama."""
    of_slice = slice_camera()
    right, down = camera.ray_slopes()
    turned = (math.pi - yaw + np.arctan(right)) % (2.0 * math.pi)
    number = np.floor(turned / (2.0 * math.pi / SLICES)).astype(int)
    off = turned - (number + 0.5) * 2.0 * math.pi / SLICES
    columns = number * of_slice.width + np.floor(of_slice.cx + of_slice.fx * np.tan(off)).astype(
        int
    )
    shrink = np.cos(np.arctan(right)) / np.cos(off)
    rows = np.floor(of_slice.cy + of_slice.fy * down[:, None] * shrink[None, :]).astype(int)
    return panorama.rgb[rows, columns[None, :]], panorama.instance_ids[rows, columns[None, :]]


@pytest.mark.parametrize("seam", [0, 3, 6])
def test_at_its_seams_a_panorama_is_what_the_camera_sees(seam, grid, renderer):
    config = CameraConfig(width=320, height=240)
    x, y = grid.centres()[200].tolist()
    panorama = draw_panorama((x, y), grid=grid, renderer=renderer)
    yaw = math.pi - seam * 2.0 * math.pi / SLICES
    direct = renderer.render(config.intrinsics, camera_pose(grid, config, Pose2(x, y, yaw)))
    colours, instances = _looked_up(panorama, config.intrinsics, yaw)
    assert (instances == direct.instance_ids).mean() > 0.98
    difference = np.abs(colours.astype(int) - direct.rgb.astype(int)).max(axis=2)
    assert np.median(difference) <= 6
    at_seam = difference[:, 150:170]
    assert np.median(at_seam) <= 6
    assert (at_seam > 40).mean() < 0.06


def test_two_renderers_draw_the_same_file(builtin_scene, grid, renderer):
    x, y = grid.centres()[0].tolist()
    with closing(CpuRenderer(builtin_scene)) as other:
        one, two = (draw_panorama((x, y), grid=grid, renderer=r).webp() for r in (renderer, other))
    assert one == two


@pytest.mark.slow
def test_what_is_said_to_be_seen_is_seen_by_the_camera(walk, builtin_scene, grid, renderer):
    config = CameraConfig(width=160, height=120)
    for place in walk["positions"][::5]:
        x, y = place["at"]
        for name, degrees, tenths in place["seen"]:
            pose = camera_pose(grid, config, Pose2(x, y, math.radians(degrees)))
            view = renderer.render(config.intrinsics, pose)
            ids = {
                i.id
                for i in builtin_scene.instances
                if i.label is not None and i.label.category == walk["names"][name]
            }
            shown = np.isin(view.instance_ids, list(ids))
            assert shown[:, 70:90].any(), (place["at"], walk["names"][name])
            depths = view.depth[shown]
            assert depths.min() * 0.75 - 0.2 < tenths / 10.0 < depths.max() * 1.3 + 0.2


@pytest.mark.slow
def test_the_page_holds_a_panorama_for_every_position_and_needs_no_network(page, walk, grid):
    assert len(walk["panoramas"]) == len(walk["positions"]) > 10
    camera = slice_camera()
    for text in walk["panoramas"]:
        with Image.open(io.BytesIO(base64.b64decode(text))) as image:
            assert image.format == "WEBP"
            assert image.size == (SLICES * camera.width, camera.height)
    assert all(grid.is_standable(*place["at"]) for place in walk["positions"])
    text = page.read_text()
    assert not re.search(r'(?:src|href)="(?!data:|#)', text)
    assert "fetch(" not in text
    assert page.stat().st_size < 2e6


@pytest.mark.slow
def test_the_page_of_a_large_office_stays_small(tmp_path):
    page = building_page(Building("offices", 39), tmp_path)
    assert page.stat().st_size < 5e6


def test_an_interrupted_page_leaves_the_old_one_and_nothing_else(tmp_path, monkeypatch):
    path = page_of_text(tmp_path, monkeypatch, "old")

    def interrupted(*_: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(os, "fsync", interrupted)
    with pytest.raises(KeyboardInterrupt):
        page_of_text(tmp_path, monkeypatch, "new")
    assert [file.name for file in tmp_path.iterdir()] == [path.name]
    assert path.read_text() == "old"


def page_of_text(folder: Path, monkeypatch: pytest.MonkeyPatch, text: str) -> Path:
    monkeypatch.setattr(page_module, "_page", lambda building, progress: text)
    return building_page(BUILDING, folder)


@pytest.fixture(scope="module")
def driver() -> Iterator[webdriver.Chrome]:
    if shutil.which("chromedriver") is None:
        pytest.skip("Chromium and its driver are not installed")
    options = webdriver.ChromeOptions()
    for argument in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--disable-gpu"):
        options.add_argument(argument)
    options.add_argument("--window-size=1200,1000")
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    driver = webdriver.Chrome(options, webdriver.ChromeService(shutil.which("chromedriver")))
    yield driver
    driver.quit()


@pytest.mark.slow
def test_one_walks_by_keyboard_by_click_and_by_name(page, walk, driver):
    driver.get(page.as_uri())

    def said() -> str:
        return driver.find_element(By.ID, "here").text

    def until_other_than(before: str) -> None:
        WebDriverWait(driver, 30.0, 0.05).until(lambda _: said() not in ("", before))

    def me() -> str:
        return driver.find_element(By.CSS_SELECTOR, ".plan svg > g:last-of-type").get_attribute(
            "transform"
        )

    def place() -> list[float]:
        return [float(n) for n in re.findall(r"-?[\d.]+", me().partition(")")[0])]

    WebDriverWait(driver, 30.0, 0.05).until(lambda _: "looking" in said())
    start, spoken = walk["positions"][walk["start"]["at"]], said()
    assert place() == pytest.approx([start["at"][0], -start["at"][1]])
    assert start["room"] in spoken.lower()

    driver.find_element(By.TAG_NAME, "body").send_keys(Keys.TAB)
    eye = driver.switch_to.active_element
    assert eye.get_attribute("id") == "eye"
    eye.send_keys(Keys.ARROW_LEFT)
    until_other_than(spoken)
    for _ in range(12):
        if place() != pytest.approx([start["at"][0], -start["at"][1]]):
            break
        spoken = said()
        eye.send_keys(Keys.ARROW_UP)
        eye.send_keys(Keys.ARROW_LEFT)
        until_other_than(spoken)
    now = [
        n
        for n, p in enumerate(walk["positions"])
        if place() == pytest.approx([p["at"][0], -p["at"][1]])
    ]
    assert now
    assert now[0] != walk["start"]["at"]

    goal = max(
        range(len(walk["positions"])),
        key=lambda n: math.dist(walk["positions"][n]["at"], start["at"]),
    )
    spoken = said()
    dot = driver.find_elements(By.CSS_SELECTOR, "circle.place")[goal]
    webdriver.ActionChains(driver).move_to_element(dot).click().perform()
    until_other_than(spoken)
    WebDriverWait(driver, 30.0, 0.05).until(
        lambda _: (
            place()
            == pytest.approx([walk["positions"][goal]["at"][0], -walk["positions"][goal]["at"][1]])
        )
    )
    assert walk["positions"][goal]["room"] in said().lower()

    button = driver.find_element(By.CSS_SELECTOR, "th[data-name='bed'] button")
    driver.execute_script("arguments[0].scrollIntoView()", button)
    button.click()
    assert button.get_attribute("aria-pressed") == "true"
    marks = driver.find_elements(By.CSS_SELECTOR, ".found circle")
    assert len(marks) == len(walk["where"]["bed"]) > 0
    assert driver.get_log("browser") == []
