"""The operator's page in a real browser, with a simulated robot that waits for goals."""

import json
import math
import re
import shutil
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.support.ui import WebDriverWait

from browsers import chromium
from hypernav.app.show.video_frame import EpisodeInfo
from hypernav.core.embodiment import Action
from hypernav.core.errors import LinkLostError
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.grid import Cell, OccupancyGrid
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.observation import Observation
from hypernav.core.trace import Mode, StepTrace
from hypernav.robot.client.links import HttpLink, HttpServer, ServerAddress
from hypernav.robot.client.robot_client import RobotClient, StopListener
from hypernav.robot.driving.driven_robot import DrivenRobot
from hypernav.robot.server.limits import ServerLimits
from hypernav.robot.server.page_view import PageView
from hypernav.robot.server.searches.agents import AgentPlan
from hypernav.robot.server.searches.search import Search
from hypernav.robot.server.searches.searches import Searches
from hypernav.robot.simulation.base import SimulatedBase
from hypernav.robot.wire.replies import SearchEnding
from hypernav.robot.wire.requests import OpenSearch
from hypernav.search.drawing.palette import STAIRS
from hypernav.simulator.worlds.box_room import BoxRoom
from hypernav.simulator.worlds.drawing.renderer import CpuRenderer, RenderConfig
from hypernav.simulator.worlds.simulation import SimulatedWorld
from servers.processes import serving_process, simulate
from servers.robots import TOKEN, RobotLink, body_of, drive, real_plan, robot_server
from small_episodes import episode_from
from small_worlds import small_config, two_rooms

pytestmark = pytest.mark.skipif(
    shutil.which("chromedriver") is None, reason="Chromium and its driver are not installed"
)
_PATIENCE_S = 60.0


class Page:
    """The page as a person sees it."""

    def __init__(self, driver: webdriver.Chrome) -> None:
        self.driver = driver

    def __getattr__(self, name: str) -> Any:
        return self.driver.find_element(By.ID, name.replace("_", "-"))

    def until(self, is_so: Callable[[], object], patience_s: float = _PATIENCE_S) -> None:
        WebDriverWait(self.driver, patience_s, 0.05).until(lambda _: is_so())

    def ask_for(self, goal: str) -> None:
        self.until(self.send.is_enabled)
        self.goal.clear()
        self.goal.send_keys(goal)
        self.send.click()

    @property
    def map_size_m(self) -> tuple[float, ...]:
        """Width and height of the map, as a screen reader hears them."""
        words = self.map.get_attribute("aria-label") or ""
        return tuple(map(float, re.findall(r"[\d.]+", words.partition("metres")[0])))


@pytest.fixture(scope="module")
def driver() -> Iterator[webdriver.Chrome]:
    with chromium("--disable-gpu", "--window-size=1200,1000") as browser:
        yield browser


@pytest.fixture
def page(driver) -> Iterator[Page]:
    driver.get_log("browser")
    yield Page(driver)
    driver.get("about:blank")


@contextmanager
def remembering_server(page: Page, state: Path, home: Path) -> Iterator[RobotLink]:
    """A server whose memory holds the things of a search."""
    with robot_server(
        state, lambda request: replace(real_plan(request), memory=home), memory=home
    ) as link:
        drive(link, link.open(), BoxRoom())
        page.until(lambda: link.call("GET", "/v1/things").json)
        yield link


@dataclass
class WaitingRobot:
    """A simulated robot at real speed that takes one goal after the other from the operator.

    Attributes:
        endings: Endings of its searches; None if a stop came before the next answer.
    """

    base: SimulatedBase
    address: ServerAddress
    endings: list[SearchEnding | None] = field(default_factory=list)
    is_leaving: threading.Event = field(default_factory=threading.Event)

    def run(self) -> None:
        start = Pose2(2.0, 1.0, 0.0)
        with closing(HttpServer(self.address)) as server:
            while not self.is_leaving.is_set():
                try:
                    given = server.wait_for_goal("anna", wait_s=0.5)
                except LinkLostError:
                    continue
                if given.goal is not None:
                    self.base.place(episode_from(start), np.random.default_rng(0))
                    self.search(server, given.goal, given.key)
                    start = self.base.pose

    def search(self, server: HttpServer, goal: str, key: str | None) -> None:
        request = OpenSearch(goal=goal, key=key, embodiment=self.base.embodiment, labels=True)
        opened = server.open(request)
        client = RobotClient(DrivenRobot(self.base), HttpLink(self.address, opened.id))
        ending = None
        with StopListener(self.address, opened.id, client.stop):
            for step in client:
                ending = step.reply.ending
                if self.is_leaving.is_set():
                    client.stop()
        self.endings.append(ending)


@contextmanager
def waiting_robot(port: int, pace: float) -> Iterator[WaitingRobot]:
    scene, config = two_rooms().scene, small_config()
    renderer = CpuRenderer(scene, RenderConfig(threads=1))
    world = SimulatedWorld(scene, config.world, config.embodiment, renderer=renderer)
    with closing(world):
        base = SimulatedBase(world, config.world, pace=pace)
        robot = WaitingRobot(base, ServerAddress("127.0.0.1", port))
        thread = threading.Thread(target=robot.run, daemon=True)
        thread.start()
        try:
            yield robot
        finally:
            robot.is_leaving.set()
            thread.join(_PATIENCE_S)


@pytest.mark.slow
def test_stop_stops_a_robot_that_drives_to_its_goal(page, tmp_path, monkeypatch):
    """On the robot's own clock it drives for 0.3 s at most after the server has received it."""
    stops, stop_all = [], Searches.stop_all
    with robot_server(tmp_path, real_plan) as link, waiting_robot(link.port, 1.0) as robot:

        def noted(searches: Searches, reason: str):
            stops.append(robot.base.now_s)
            return stop_all(searches, reason)

        monkeypatch.setattr(Searches, "stop_all", noted)
        page.driver.get(f"http://127.0.0.1:{link.port}/")
        page.ask_for("bed")
        page.until(lambda: "Looking for “bed”" in page.headline.text)
        page.until(lambda: page.map_size_m)
        first = page.map_size_m
        page.until(lambda: page.map_size_m > first)
        page.stop.click()
        page.until(lambda: robot.endings)
        page.until(lambda: "Stopped" in page.headline.text)
        assert "the operator pressed STOP" in page.reason.text.replace("The", "the")
        (stopped_s,) = stops
        assert robot.base.now_s - stopped_s <= 0.3 + 1e-6
        assert link.call("GET", "/v1/searches").json[0]["ending"] == "stopped"
        assert not page.driver.get_log("browser")
    assert robot.endings[-1] in (None, SearchEnding.STOPPED)


@pytest.mark.slow
def test_a_goal_typed_on_the_page_is_found(page, tmp_path):
    with robot_server(tmp_path, real_plan) as link, waiting_robot(link.port, 50.0):
        page.driver.get(f"http://127.0.0.1:{link.port}/")
        page.ask_for("bed")
        page.until(lambda: page.headline.text == "Found “bed”")
        page.until(lambda: page.camera_words.text == "Sees “bed”.")
        page.until(lambda: "found" in page.searches.text)
        assert page.driver.title.startswith("bed: found")
        page.events.find_elements(By.TAG_NAME, "button")[-1].click()
        assert page.step.text.startswith("1 of ")
        assert page.live.get_attribute("aria-pressed") == "false"
        page.live.click()
        assert page.live.get_attribute("aria-pressed") == "true"
        assert not page.driver.get_log("browser")


@pytest.mark.slow
@pytest.mark.parametrize(
    "options",
    [("--link", "http"), ("--link", "websocket", "--motion", "continuous")],
    ids=["http", "websocket"],
)
def test_the_bed_of_the_small_house_is_found_between_processes_as_the_page_shows(
    page, options, small_house, tmp_path
):
    with serving_process(tmp_path / "state") as (_, address):
        page.driver.get(address)
        page.until(lambda: page.connection.text.endswith("Connected"))
        command = simulate(small_house, address, *options)
        with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as robot:
            page.until(lambda: page.map_size_m or robot.poll() is not None, 300.0)
            first = page.map_size_m
            page.until(lambda: page.map_size_m > first or robot.poll() is not None, 300.0)
            assert page.map_size_m > first
            _, said = robot.communicate(timeout=300.0)
        assert robot.returncode == 0, said
        assert "found the bed" in said
        page.until(lambda: page.headline.text == "Found “bed”")
        assert not page.driver.get_log("browser")


def test_the_page_survives_a_restart_of_the_server(page, tmp_path):
    with robot_server(tmp_path) as link:
        search, port = link.open("quick"), link.port
        page.driver.get(f"http://127.0.0.1:{port}/")
        link.observe(search, body_of(0))
        page.until(lambda: page.step.text == "1 of 1")
        assert page.connection.text.endswith("Connected")
    page.until(lambda: "No connection" in page.connection.text)
    page.stop.click()
    page.until(lambda: "STOP did not reach the server" in page.alarm.text)
    with robot_server(tmp_path, port=port) as link:
        page.until(lambda: page.connection.text.endswith("Connected"))
        page.until(lambda: page.headline.text == "Stopped, looking for “quick”")
        assert not page.alarm.is_displayed()
        assert link.call("GET", search).json["ending"] == "stopped"


def test_a_stop_without_an_answer_is_said(page, tmp_path, monkeypatch):
    may_go_on, stop_all = threading.Event(), Searches.stop_all

    def hang(searches: Searches, reason: str) -> list[Search]:
        may_go_on.wait(_PATIENCE_S)
        return stop_all(searches, reason)

    with robot_server(tmp_path) as link:
        link.open("quick")
        page.driver.get(f"http://127.0.0.1:{link.port}/")
        page.until(lambda: page.connection.text.endswith("Connected"))
        monkeypatch.setattr(Searches, "stop_all", hang)
        page.stop.click()
        assert page.stop.text == "STOP …"
        page.until(lambda: "The server has not confirmed STOP." in page.alarm.text)
        assert "emergency stop" in page.alarm.text
        page.until(lambda: "No connection" in page.connection.text)
        may_go_on.set()
        page.until(lambda: page.headline.text == "Stopped, looking for “quick”")
        page.until(lambda: not page.alarm.is_displayed())
        assert page.stop.text == "STOP"


def test_a_silent_robot_is_shown_as_silent_and_a_stopped_one_as_stopping(
    page, tmp_path, monkeypatch
):
    with robot_server(tmp_path, limits=ServerLimits(idle_s=1e6)) as link:
        search = link.open("quick")
        link.observe(search, body_of(0))
        page.driver.get(f"http://127.0.0.1:{link.port}/")
        page.until(lambda: page.action.text == "forward")
        now_s = time.monotonic() + 27 * 60.0
        monkeypatch.setattr("hypernav.robot.server.searches.search.monotonic", lambda: now_s)
        page.driver.refresh()
        page.until(lambda: "silent for 27 min" in page.reason.text)
        page.until(lambda: "silent for 27 min" in page.searches.text)
        assert page.driver.find_element(By.TAG_NAME, "body").get_attribute("data-silent") == "true"
        page.stop.click()
        page.until(lambda: page.headline.text == "Stopped, looking for “quick”")
        assert page.action.text == "stop"
        assert page.driver.find_element(By.TAG_NAME, "body").get_attribute("data-silent") == "false"


@pytest.mark.slow
def test_the_token_is_asked_for_and_kept_in_this_tab(page, tmp_path):
    with robot_server(tmp_path, token=TOKEN) as link:
        search = link.open("quick")
        link.observe(search, body_of(0))
        page.driver.get(f"http://127.0.0.1:{link.port}/")
        page.until(page.token.is_displayed)
        page.token.send_keys("x" * 16 + "\n")
        page.until(lambda: "not accepted" in page.token_words.text)
        page.token.send_keys(TOKEN + "\n")
        page.until(lambda: page.headline.text == "Looking for “quick”")
        page.driver.refresh()
        page.until(lambda: page.headline.text == "Looking for “quick”")
        assert TOKEN not in page.driver.page_source


def test_every_control_has_a_name_and_nothing_is_wider_than_a_phone(page, tmp_path):
    with robot_server(tmp_path) as link:
        search = link.open("a goal with a very long name " * 5)
        link.observe(search, body_of(0))
        page.driver.set_window_size(390, 844)
        page.driver.get(f"http://127.0.0.1:{link.port}/")
        page.until(lambda: "a goal" in page.headline.text)
        page.until(lambda: page.searches.find_elements(By.TAG_NAME, "button"))
        controls = page.driver.find_elements(By.CSS_SELECTOR, "button, input, select, summary")
        assert len(controls) >= 8
        for control in controls:
            if control.is_displayed():
                assert control.accessible_name, control.get_attribute("outerHTML")
        width = page.driver.execute_script(
            "return [document.documentElement.scrollWidth, innerWidth]"
        )
        page.driver.set_window_size(1200, 1000)
    assert width[0] <= width[1]


def test_the_page_loads_nothing_from_elsewhere(tmp_path):
    with robot_server(tmp_path, token=TOKEN) as link:
        stranger = link.__class__(link.port)
        index = stranger.call("GET", "/")
        assert index.status == 200
        assert "default-src 'none'" in index.headers["content-security-policy"]
        assert "unsafe" not in index.headers["content-security-policy"]
        text = index.content.decode()
        assert "http:" not in text
        assert "https:" not in text
        for name in re.findall(r'(?:src|href)="(page/[^"]+)"', text):
            assert stranger.call("GET", f"/{name}").status == 200
        for name in ("nothing.js", "..%2ffiles.py", "%2e%2e/files.py"):
            assert stranger.call("GET", f"/page/{name}").status == 404


def test_the_map_is_that_of_the_shown_steps_floor_and_says_so(page, driver):
    info = EpisodeInfo("bed", "hypernav", detector="ground truth", reasoner="geometric")
    floors, sizes = (None, 1, 2, 1), (60, 60, 100, 70)
    with closing(PageView(info, lambda: None)) as view:
        driver.get(view.address.partition(" ")[0])
        for number, (floor, columns) in enumerate(zip(floors, sizes, strict=True)):
            trace = StepTrace(
                step=number,
                pose=(0.1 * number, 0.0, 0.0),
                action=Action.MOVE_FORWARD,
                mode=Mode.CLIMB if number == 1 else Mode.EXPLORE,
                reason="on the stairs to floor 2",
                floor=floor,
            )
            cells = np.full((40, columns), Cell.FREE, dtype=np.uint8)
            view.add(trace, OccupancyGrid(cells, 0.05, (0.0, 0.0)), None)
            page.until(lambda count=number + 1: page.step.text == f"{count} of {count}")
            page.until(lambda width=columns * 0.05: page.map_size_m[:1] == (width,))
        assert page.map_title.text == "Map of floor 1"
        assert page.floor_words.text == "Floor 1 (start). The robot is here."
        page.slider.send_keys(Keys.ARROW_LEFT)
        page.until(lambda: page.map_title.text == "Map of floor 2")
        assert page.map_size_m == (5.0, 2.0)


def floor_steps(*floors: int | None) -> list[StepTrace]:
    """Steps of 1 m along x; the robot climbs at every step before it comes to another floor."""
    after = (*floors[1:], floors[-1])
    return [
        StepTrace(
            step=number,
            pose=(float(number), 0.0, 0.0),
            action=Action.MOVE_FORWARD,
            mode=Mode.CLIMB if (after[number] or 1) != (floor or 1) else Mode.EXPLORE,
            reason="on its way",
            floor=floor,
        )
        for number, floor in enumerate(floors)
    ]


def test_a_page_opened_late_has_the_maps_of_all_floors(page, driver):
    info = EpisodeInfo("bed", "hypernav", detector="ground truth", reasoner="geometric")
    with closing(PageView(info, lambda: None)) as view:
        for trace, columns in zip(
            floor_steps(None, None, 2, 3, 3), (60, 60, 100, 80, 90), strict=True
        ):
            cells = np.full((40, columns), Cell.FREE, dtype=np.uint8)
            view.add(trace, OccupancyGrid(cells, 0.05, (0.0, 0.0)), None)
        driver.get(view.address.partition(" ")[0])
        page.until(lambda: page.map_title.text == "Map of floor 3")
        for floor, columns in ((1, 60), (2, 100), (3, 90)):
            driver.find_element(By.CSS_SELECTOR, f"button[data-floor='{floor}']").click()
            assert page.map_title.text == f"Map of floor {floor}"
            assert page.map.get_attribute("aria-label").startswith(f"Map: {columns * 0.05:.1f} by")
            where = "The robot is here." if floor == 3 else "The robot is on floor 3."
            assert page.floor_words.text.endswith(where)
        driver.find_element(By.CSS_SELECTOR, "button[data-floor='1']").click()
        page.slider.send_keys(Keys.HOME)
        page.slider.send_keys(Keys.END)
        page.until(lambda: page.map_title.text == "Map of floor 3")


def test_a_floor_without_a_map_is_asked_for_once(page, driver):
    info = EpisodeInfo("bed", "hypernav", detector="ground truth", reasoner="geometric")
    grid = OccupancyGrid(np.full((40, 60), Cell.FREE, np.uint8), 0.05, (0.0, 0.0))
    with closing(PageView(info, lambda: None)) as view:
        for trace in floor_steps(1, 2, 2, 2, 2):
            view.add(trace, None if trace.floor == 1 else grid, None)
            if trace.step == 1:
                driver.get(view.address.partition(" ")[0])
            if trace.step >= 1:
                page.until(lambda count=trace.step + 1: page.step.text == f"{count} of {count}")
        asked = driver.execute_script(
            """return performance.getEntriesByType("resource")
            .filter((one) => one.name.endsWith("/floors")).length;"""
        )
        assert asked == 1


def test_a_search_with_a_memory_may_begin_on_any_floor(page, driver):
    info = EpisodeInfo("bed", "hypernav", detector="ground truth", reasoner="geometric")
    grid = OccupancyGrid(np.full((40, 60), Cell.FREE, np.uint8), 0.05, (0.0, 0.0))
    with closing(PageView(info, lambda: None)) as view:
        for trace in floor_steps(4, 4, 2):
            view.add(trace, grid, None)
        driver.get(view.address.partition(" ")[0])
        page.until(lambda: page.map_title.text == "Map of floor 2")
        assert page.floor_words.text.startswith("Floor 2. The robot is here.")
        buttons = page.floors.find_elements(By.TAG_NAME, "button")
        assert [one.text for one in buttons] == ["Floor 2", "Floor 4 (start)"]
        buttons[1].click()
        assert page.floor_words.text == "Floor 4 (start). The robot is on floor 2."


def seen_from(height_m: float) -> Observation:
    """What a camera sees that is so high above the ``map`` frame's origin, metres."""
    return Observation(
        rgb=np.zeros((3, 4, 3), np.uint8),
        depth=np.ones((3, 4), np.float32),
        camera=PinholeCamera.from_hfov(4, 3, 79.0),
        camera_to_map=Transform(np.eye(3), np.array([0.0, 0.0, height_m])),
        robot=Pose2(0.0, 0.0, 0.0),
    )


def test_the_page_says_how_high_floors_are_and_when_the_robot_is_on_stairs(page, driver):
    info = EpisodeInfo("bed", "hypernav", detector="ground truth", reasoner="geometric")
    steps = floor_steps(None, None, None, 2)
    grid = OccupancyGrid(np.full((40, 60), Cell.FREE, np.uint8), 0.05, (0.0, 0.0))

    def event_words() -> list[str]:
        return [one.text for one in page.events.find_elements(By.TAG_NAME, "span")]

    with closing(PageView(info, lambda: None)) as view:
        driver.get(view.address.partition(" ")[0])
        for trace, height_m in zip(steps, (0.9, 0.9, 2.0, 3.9), strict=True):
            view.add(trace, grid, seen_from(height_m))
            page.until(lambda count=trace.step + 1: page.step.text == f"{count} of {count}")
            if trace.step == 1:
                assert page.map_title.text == "Map"
                assert not page.floor_band.is_displayed()
                assert event_words() == ["Exploring"]
            if trace.step == 2:
                assert page.map_title.text == "Map of floor 1"
                words = "Floor 1 (start). The robot is on the stairs from floor 1."
                assert page.floor_words.text == words
                assert page.reason.text == "On the stairs from floor 1: on its way"
                assert page.floor_band.is_displayed()
        buttons = page.floors.find_elements(By.TAG_NAME, "button")
        assert [one.text for one in buttons] == [
            "Floor 1 (start)",
            "Floor 2 (3.0 m above the start)",
        ]
        assert event_words() == [
            "Exploring on floor 2 (3.0 m above the start)",
            "On the stairs from floor 1",
            "Exploring",
        ]
        page.slider.send_keys(Keys.ARROW_LEFT)
        page.until(lambda: "to floor 2" in page.floor_words.text)
        assert page.reason.text == "On the stairs from floor 1 to floor 2: on its way"


def test_stairs_are_marked_as_far_as_the_shown_step_knows_them(page, driver):
    info = EpisodeInfo("bed", "hypernav", detector="ground truth", reasoner="geometric")
    grid = OccupancyGrid(np.full((40, 120), Cell.FREE, np.uint8), 0.05, (0.0, -1.0))
    brown = f"rgb{STAIRS}"

    def marked() -> int:
        return driver.execute_script(
            """const [map, colour] = [document.getElementById("map"), arguments[0]];
            const { data } = map.getContext("2d").getImageData(0, 0, map.width, map.height);
            let count = 0;
            for (let k = 0; k < data.length; k += 4)
              count += `rgb(${data[k]}, ${data[k + 1]}, ${data[k + 2]})` === colour;
            return count;""",
            brown,
        )

    with closing(PageView(info, lambda: None)) as view:
        for trace in floor_steps(None, None, None, 2, 2):
            view.add(trace, grid, None)
        driver.get(view.address.partition(" ")[0])
        page.until(lambda: page.map_title.text == "Map of floor 2")
        page.until(marked)
        page.slider.send_keys(Keys.HOME)
        page.until(lambda: page.map_title.text == "Map of floor 1")
        assert not marked()
        page.slider.send_keys(Keys.END)
        page.until(lambda: page.map_title.text == "Map of floor 2")
        assert marked()


def test_the_page_asks_for_stairs_when_a_climb_begins_or_ends(page, driver):
    info = EpisodeInfo("bed", "hypernav", detector="ground truth", reasoner="geometric")
    modes = [Mode.EXPLORE, *[Mode.CLIMB] * 4, Mode.EXPLORE, Mode.EXPLORE]
    with closing(PageView(info, lambda: None)) as view:
        driver.get(view.address.partition(" ")[0])
        for number, trace in enumerate(floor_steps(*[None] * len(modes)), 1):
            view.add(trace.model_copy(update={"mode": modes[number - 1]}), None, None)
            page.until(lambda count=number: page.step.text == f"{count} of {count}")
        asked = driver.execute_script(
            """return performance.getEntriesByType("resource")
            .filter(({ name }) => name.endsWith("/stairs")).length;"""
        )
    assert asked == 2


@pytest.mark.slow
def test_the_page_notes_which_things_have_no_way_and_says_that_the_memory_is_broken(page, tmp_path):
    home = tmp_path / "home"
    with remembering_server(page, tmp_path / "state", home) as link:
        index = json.loads((home / "memory.json").read_text())
        floor = index["floors"][0]
        state = floor["state"] | {"name": "floor-2/state-1.npz"}
        shutil.copytree(home / "floor-1", home / "floor-2")
        index["floors"].append(floor | {"z": 3.0, "state": state})
        (home / "memory.json").write_text(json.dumps(index))
        page.driver.get(f"http://127.0.0.1:{link.port}/")

        def buttons() -> list[bool]:
            link.call("POST", "/v1/robots/anna/wait")
            return [one.is_enabled() for one in page.things.find_elements(By.TAG_NAME, "button")]

        page.until(lambda: buttons() == [True, True])
        note = "Note: a robot on floor 1, where the last search ended, has no way there."
        assert note in page.things.text
        page.driver.set_window_size(1000, 1000)
        heights = page.driver.execute_script(
            """const high = (o) => o.offsetHeight / parseFloat(getComputedStyle(o).lineHeight);
            return [...document.querySelectorAll("#things .when:not(.why)")].map(high);"""
        )
        page.driver.set_window_size(1200, 1000)
        assert heights == pytest.approx([1.0, 1.0], abs=0.2)  # nothing is wrapped
        (home / "memory.json").write_text("{")
        page.until(lambda: "memory.json is broken" in page.memory.text)
        assert len(buttons()) == 2
        page.driver.refresh()
        page.until(lambda: "memory.json is broken" in page.memory.text)
        assert buttons() == []


@pytest.mark.slow
def test_a_remembered_thing_has_its_picture_and_its_place_on_the_map(page, tmp_path):
    home = tmp_path / "home"
    with remembering_server(page, tmp_path / "state", home) as link:
        page.driver.get(f"http://127.0.0.1:{link.port}/")
        picture = "#things canvas[data-drawn=true]"
        page.until(lambda: page.driver.find_elements(By.CSS_SELECTOR, "#things canvas"))
        page.driver.execute_script("document.getElementById('things').scrollIntoView()")
        page.until(lambda: page.driver.find_elements(By.CSS_SELECTOR, picture))
        page.until(lambda: page.map_size_m)
        whole = page.map.screenshot_as_png
        page.driver.find_element(By.CSS_SELECTOR, "[data-zoom='1.5']").click()
        page.until(lambda: page.map.screenshot_as_png != whole)
        nearer = page.map.screenshot_as_png
        ActionChains(page.driver).drag_and_drop_by_offset(page.map, 40, 30).perform()
        page.until(lambda: page.map.screenshot_as_png != nearer)
        page.driver.find_element(By.CSS_SELECTOR, "[data-zoom='0']").click()
        page.until(lambda: page.map.get_attribute("data-zoomed") == "false")
        assert not page.driver.get_log("browser")


@pytest.mark.slow
def test_an_empty_page_says_what_to_run_and_a_searching_robot_is_named(page, tmp_path):
    with robot_server(tmp_path) as link:
        page.driver.get(f"http://127.0.0.1:{link.port}/")
        page.until(lambda: page.connection.text.endswith("Connected"))
        command = f"hypernav robot wait --server http://127.0.0.1:{link.port} --scene houses:7"
        assert page.driver.find_element(By.ID, "try").text == command
        assert "No robot waits for a goal." in page.find_words.text
        link.observe(link.open("quick"), body_of(0))
        page.until(lambda: "The robot is looking for “quick”" in page.find_words.text)
        assert not page.empty.is_displayed()


@pytest.mark.slow
def test_the_page_says_what_became_of_a_start_that_the_robot_did_not_know(page, tmp_path):
    def plan(request: OpenSearch) -> AgentPlan:
        return replace(real_plan(request), memory=tmp_path / "home", relocalize=True)

    with robot_server(tmp_path / "state", plan) as link:
        drive(link, link.open(), BoxRoom())
        room, search = BoxRoom(Pose2(0.5, 0.0, math.pi)), link.open()  # looks alike from both ends
        page.driver.get(f"http://127.0.0.1:{link.port}/")
        replies = drive(link, search, room, most=3)
        page.until(lambda: "finding out where it is in the memory" in page.reason.text)
        assert not page.start.is_displayed()
        replies += drive(link, search, room, first=3)
        page.until(lambda: page.headline.text == "Found “door”")
        assert page.start.text.startswith("Start: not found in the memory: ")
        assert page.start.text.endswith("The search began anew; the memory stays as it was.")
        assert page.step.text == f"{len(replies)} of {len(replies)}"
        first = page.driver.find_elements(By.CSS_SELECTOR, "#events button")[-1]
        assert first.text == "Step 12"  # those of the turn before have no trace
        first.click()
        page.until(lambda: page.step.text == f"12 of {len(replies)}")


def test_a_place_is_closed_by_a_click_on_the_map_and_opened_by_keys(page, tmp_path):
    with robot_server(tmp_path, real_plan) as link:
        search = link.open()
        drive(link, search, BoxRoom(), most=1)
        page.driver.get(f"http://127.0.0.1:{link.port}/")
        page.until(lambda: page.map_size_m)
        page.until(lambda: (page.map.click(), page.place.is_displayed())[1])
        button = page.place.find_element(By.XPATH, ".//button[text()='Do not enter']")
        assert button.size["height"] >= 40
        button.click()
        page.until(lambda: link.call("GET", f"{search}/no-entry").json)
        (area,) = link.call("GET", f"{search}/no-entry").json
        assert (area["radius_m"], area["floor"]) == (0.5, 1)
        page.until(lambda: not page.place.is_displayed())
        page.until(
            lambda: (
                page.map.send_keys(Keys.ENTER),
                page.place.find_elements(By.XPATH, ".//button[text()='Allow again']"),
            )[1]
        )
        page.driver.switch_to.active_element.send_keys(Keys.ENTER)
        page.until(lambda: link.call("GET", f"{search}/no-entry").json == [])


def test_a_robot_is_sent_to_a_place_by_a_click_on_the_map_and_called_back(page, tmp_path):
    with robot_server(tmp_path, real_plan) as link:
        room, search = BoxRoom(), link.open("piano")
        drive(link, search, room, most=1)
        page.driver.get(f"http://127.0.0.1:{link.port}/")
        page.until(lambda: page.map_size_m)
        page.until(lambda: (page.map.click(), page.place.is_displayed())[1])
        assert not page.going.is_displayed()
        before = page.map.screenshot_as_png
        page.place.find_element(By.XPATH, ".//button[text()='Go there']").click()
        page.until(lambda: "is on its way to the chosen place" in page.going.text)
        assert link.call("GET", f"{search}/go-to").json["state"] == "on its way"
        assert page.map.screenshot_as_png != before
        cancel = page.going.find_element(By.XPATH, ".//button[text()='Cancel going there']")
        assert cancel.size["height"] >= 40
        cancel.click()
        page.until(lambda: not page.going.is_displayed())
        assert link.call("GET", f"{search}/go-to").json is None
        link.call("PUT", f"{search}/go-to", {"x": 1.5, "y": 0.5})
        drive(link, search, room, first=1, most=10)
        page.until(lambda: "has reached the chosen place at 1.5, 0.5." in page.going.text)
        assert not cancel.is_displayed()
        link.call("POST", "/v1/stop", {})
        page.until(lambda: not page.going.is_displayed())
        assert not page.driver.get_log("browser")
