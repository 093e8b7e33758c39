import base64
import json
import re
from collections.abc import Callable, Iterator
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from selenium import webdriver
from selenium.webdriver.common.by import By

from browsers import chromium
from hypernav.app.show.episode_page import write_page
from hypernav.app.show.templating import page_environment
from hypernav.app.show.video_frame import _CAMERA, _MARGIN, _TOP, WIDTH
from hypernav.core.geometry.grid import OccupancyGrid
from hypernav.core.trace import DetectionRecord, Exchange, Mode, StepTrace

MakeStep = Callable[..., StepTrace]
VOID = frozenset({"meta", "img", "input", "br", "link", "hr", "source"})
SVG_SHAPES = frozenset({"rect", "circle", "path"})
ADDRESSES = ("src", "href", "srcset", "poster", "action", "data", "xlink:href")


class Page(HTMLParser):
    """Reads a page and fails where tags don't match."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str]]] = []
        self.texts: dict[str, str] = {}
        self.visible = ""
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, {name: value or "" for name, value in attrs}))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, {name: value or "" for name, value in attrs}))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        tag = self.open[-1] if self.open else ""
        self.texts[tag] = self.texts.get(tag, "") + data
        if not {"script", "style"} & set(self.open):
            self.visible += data

    def with_tag(self, tag: str) -> list[dict[str, str]]:
        return [attributes for name, attributes in self.tags if name == tag]

    @property
    def addresses(self) -> list[str]:
        return [a[name] for _, a in self.tags for name in ADDRESSES if name in a]


@pytest.fixture
def steps(make_step: MakeStep, sighting: DetectionRecord) -> list[StepTrace]:
    found = make_step(5, events=["goal seen"], detections=[sighting], goal_area=[[(1.0, 0.0)] * 3])
    return [*(make_step(n) for n in range(5)), found]


def read(path: Path) -> Page:
    return Page(path.read_text(encoding="utf-8"))


def player(page: Page) -> dict[str, Any]:
    return json.loads(page.texts["script"].strip().splitlines()[0])


def test_the_page_tells_the_whole_story(
    steps: list[StepTrace], result: dict[str, Any], room: OccupancyGrid, tmp_path: Path
) -> None:
    page = read(write_page(tmp_path / "new", result, steps, {1: room}))
    assert "Found “bed”" in page.texts["h1"]
    for expected in ("0.61", "0.63", "23.5", "14.40", "0.04", "small_house", "default settings"):
        assert expected in page.visible
    assert "ground truth labels from the simulator" in page.visible
    assert "it looks like a kitchen" in page.visible
    assert "Goal seen" in page.visible
    assert "resolution_m: 0.05" in page.texts["pre"]
    assert len(page.with_tag("button")) >= 2


@pytest.mark.parametrize(
    ("memory", "words"),
    [
        ({}, "searched a building that it had never seen, for"),
        ({"memory": {"folder": "flat", "earlier_searches": 0}}, "that it had never seen, for"),
        ({"memory": {"folder": "flat", "earlier_searches": 1}}, "been in 1 earlier search, for"),
        ({"memory": {"earlier_searches": 3}}, "a building where it had been in 3 earlier searches"),
    ],
)
def test_the_page_says_whether_the_robot_had_been_there(
    result: dict[str, Any], memory: dict[str, Any], words: str, tmp_path: Path
) -> None:
    assert words in read(write_page(tmp_path, result | memory, [], {})).visible


def test_a_search_without_a_step_has_searched_no_building(
    result: dict[str, Any], tmp_path: Path
) -> None:
    page = read(write_page(tmp_path, result | {"steps": 0}, [], {}))
    assert "The search ended before its first step." in page.visible
    assert "searched a building" not in page.visible


def test_the_page_needs_no_network(
    steps: list[StepTrace], result: dict[str, Any], room: OccupancyGrid, tmp_path: Path
) -> None:
    (tmp_path / "episode.mp4").write_bytes(b"a film")
    path = write_page(tmp_path, result, steps, {1: room})
    page = read(path)
    assert all(address.startswith("data:") for address in page.addresses)
    assert page.with_tag("link") == []
    style = page.texts["style"]
    assert "url(" not in style
    assert "@import" not in style
    policy = next(
        m["content"] for m in page.with_tag("meta") if "content" in m and "none" in m["content"]
    )
    assert policy.startswith("default-src 'none'")
    assert "http" not in policy


def test_the_video_is_inside_unless_it_is_large(
    steps: list[StepTrace], result: dict[str, Any], room: OccupancyGrid, tmp_path: Path
) -> None:
    (tmp_path / "episode.mp4").write_bytes(b"a film")
    inside = read(write_page(tmp_path, result, steps, {1: room})).with_tag("video")[0]["src"]
    assert base64.b64decode(inside.removeprefix("data:video/mp4;base64,")) == b"a film"
    other = tmp_path / "films" / "my film.mp4"
    other.parent.mkdir()
    other.write_bytes(b"another film")
    page = read(write_page(tmp_path, result, steps, {1: room}, video=other, embed_limit_bytes=3))
    assert page.with_tag("video")[0]["src"] == "films/my%20film.mp4"


def test_what_models_and_people_write_cannot_become_markup(
    make_step: MakeStep, result: dict[str, Any], room: OccupancyGrid, tmp_path: Path
) -> None:
    evil = "</script><script>alert('x')</script><img src=http://evil.example/x onerror=1>"
    asked = make_step(2)
    exchanges = [
        exchange.model_copy(update={"question": evil, "answer": evil, "probabilities": {evil: 1.0}})
        for exchange in asked.exchanges
    ]
    step = make_step(2, reason=evil, exchanges=exchanges, events=[evil])
    result |= {"goal": evil, "scene": evil, "config": {evil: evil}, "detector": evil}
    page = read(write_page(tmp_path, result, [step], {1: room}))
    assert len(page.with_tag("script")) == 6
    assert all(address.startswith("data:") for address in page.addresses)
    assert evil in page.texts["h1"]
    assert player(page)["reasons"] == [evil]


def over_two_floors(make_step: MakeStep) -> list[StepTrace]:
    """Two steps on floor 1, two on the stairs, two on floor 2, 3 m higher."""
    modes = [Mode.EXPLORE, Mode.EXPLORE, Mode.CLIMB, Mode.CLIMB, Mode.EXPLORE, Mode.EXPLORE]
    floors, heights_m = [None, None, None, None, 2, 2], [0.1, 0.1, 0.2, 1.6, 3.1, 3.1]
    return [
        make_step(k, mode=mode, floor=floor, z=z)
        for k, (mode, floor, z) in enumerate(zip(modes, floors, heights_m, strict=True))
    ]


def test_every_floor_has_its_map_and_the_robot_is_on_one_of_them(
    make_step: MakeStep, result: dict[str, Any], room: OccupancyGrid, tmp_path: Path
) -> None:
    steps = over_two_floors(make_step)
    page = read(write_page(tmp_path, result, steps, {1: room, 2: room}))
    data = player(page)
    assert data["floors"] == [1, 1, 1, 1, 2, 2]
    assert all(robot is not None for robot in data["robots"])
    assert data["modes"] == [
        *["Exploring on floor 1"] * 2,
        *["On the stairs from floor 1 to floor 2"] * 2,
        *["Exploring on floor 2"] * 2,
    ]
    assert len([image for image in page.with_tag("img") if "of floor" in image["alt"]]) == 2
    assert "Floor 1 (start)" in page.visible
    assert "Floor 2 (3.0 m above the start); the search ended here" in page.visible
    stairs = "Up the stairs from floor 1 to floor 2 (3.0 m above the start)"
    told = [
        f"{where} {steps}"
        for where, steps in zip(
            ("Floor 1 (start)", stairs, "Floor 2 (3.0 m above the start)"),
            ("steps 1 to 2", "steps 3 to 4", "steps 5 to 6"),
            strict=True,
        )
    ]
    places = [page.visible.index(words) for words in told]
    assert places == sorted(places)


@pytest.mark.parametrize(
    ("going_to", "words"),
    [
        ((0.2, -0.9), "Geometric rule (no model) chose them: block 7: stairs up, 0.3 m away"),
        ((5.0, 2.0), "Met on the way to something else: block 7: stairs up, 0.3 m away"),
    ],
)
def test_beside_stairs_the_page_says_why_they_were_taken(
    make_step: MakeStep,
    result: dict[str, Any],
    tmp_path: Path,
    going_to: tuple[float, float],
    words: str,
) -> None:
    steps, answer = over_two_floors(make_step), "block 7: stairs up, 0.3 m away"
    asked = Exchange(
        kind="choose block", asked="geometric", question="Which?", answer="words", chosen=7
    )
    chosen = {"reason": answer, "exchanges": [asked], "destination": going_to}
    steps[1] = steps[1].model_copy(update=chosen)
    page = read(write_page(tmp_path, result, steps, {}))
    assert words in page.visible


@pytest.mark.parametrize(
    ("on_floor_2", "on_a_screen", "on_a_phone"),
    [(1, "", ""), (7, "Floor 2", "Floor 2"), (24, "Floor 2 (3.0 m above the start)", "Floor 2")],
)
def test_the_band_names_floors_as_far_as_there_is_room(
    make_step: MakeStep,
    result: dict[str, Any],
    tmp_path: Path,
    on_floor_2: int,
    on_a_screen: str,
    on_a_phone: str,
) -> None:
    steps = over_two_floors(make_step)[:4] + [
        make_step(k, floor=2, z=3.1) for k in range(4, 4 + on_floor_2)
    ]
    steps += [make_step(len(steps) + k, floor=1, z=0.1) for k in range(30 - on_floor_2)]
    page = write_page(tmp_path, result, steps, {}).read_text()
    for screen, words in (("desk", on_a_screen), ("phone", on_a_phone)):
        told = re.findall(f'<text class="{screen}"[^>]*>([^<]*)', page)
        assert [one for one in told if "Floor 2" in one] == ([words] if words else [])


def test_a_floor_without_a_map_shows_no_robot(
    make_step: MakeStep, result: dict[str, Any], room: OccupancyGrid, tmp_path: Path
) -> None:
    data = player(read(write_page(tmp_path, result, over_two_floors(make_step), {2: room})))
    assert [robot is not None for robot in data["robots"]] == [False] * 4 + [True] * 2


def test_a_search_that_ends_on_stairs_says_so(
    make_step: MakeStep, result: dict[str, Any], room: OccupancyGrid, tmp_path: Path
) -> None:
    steps = over_two_floors(make_step)[:4]
    page = read(write_page(tmp_path, result, steps, {1: room}))
    assert "Onto stairs from floor 1; the search ended on them" in page.visible


def test_as_long_as_one_floor_is_known_no_floor_is_named(
    steps: list[StepTrace], result: dict[str, Any], room: OccupancyGrid, tmp_path: Path
) -> None:
    page = read(write_page(tmp_path, result, steps, {1: room}))
    assert "floor 1" not in page.visible.lower()
    assert not any("data-floor" in button for button in page.with_tag("button"))
    assert all("floor" not in step.model_dump() for step in steps)


@pytest.fixture
def browser() -> Iterator[webdriver.Chrome]:
    with chromium("--disable-gpu") as browser:
        yield browser


def test_on_a_phone_the_film_shows_its_camera_image_alone(
    steps: list[StepTrace],
    result: dict[str, Any],
    room: OccupancyGrid,
    tmp_path: Path,
    browser: webdriver.Chrome,
) -> None:
    (tmp_path / "episode.mp4").write_bytes(b"a film")
    browser.set_window_size(500, 900)
    browser.get(write_page(tmp_path, result, steps, {1: room}).as_uri())
    film = browser.find_element(By.CSS_SELECTOR, ".film").rect
    video = browser.find_element(By.ID, "video").rect
    scale = video["width"] / WIDTH
    shown = {
        "x": video["x"] + scale * _MARGIN,
        "y": video["y"] + scale * _TOP,
        "width": scale * _CAMERA[0],
        "height": scale * _CAMERA[1],
    }
    assert film == pytest.approx(shown, abs=1.0)


def test_a_click_shows_another_floor_until_the_robot_changes_floors(
    make_step: MakeStep,
    result: dict[str, Any],
    room: OccupancyGrid,
    tmp_path: Path,
    browser: webdriver.Chrome,
) -> None:
    path = write_page(tmp_path, result, over_two_floors(make_step), {1: room, 2: room})
    browser.get(path.as_uri())

    def shown() -> list[str | None]:
        figures = browser.find_elements(By.CSS_SELECTOR, "figure[data-floor]")
        return [one.get_attribute("data-floor") for one in figures if one.is_displayed()]

    def go_to(step: int) -> None:
        move = "slider.value = arguments[0]; slider.dispatchEvent(new Event('input'))"
        browser.execute_script(move, step)

    assert shown() == ["2"], "where the search ended"
    browser.find_element(By.CSS_SELECTOR, "button[data-floor='1']").click()
    assert shown() == ["1"]
    assert not browser.find_element(By.ID, "robot").is_displayed()
    go_to(5)
    assert shown() == ["1"], "the robot is still on floor 2"
    go_to(0)
    browser.find_element(By.CSS_SELECTOR, "button[data-floor='2']").click()
    assert shown() == ["2"]
    go_to(4)
    go_to(1)
    assert shown() == ["1"]
    assert browser.find_element(By.ID, "robot").is_displayed()


def test_on_stairs_the_page_says_so_beside_the_map(
    make_step: MakeStep,
    result: dict[str, Any],
    room: OccupancyGrid,
    tmp_path: Path,
    browser: webdriver.Chrome,
) -> None:
    path = write_page(tmp_path, result, over_two_floors(make_step), {1: room, 2: room})
    browser.get(path.as_uri())

    def go_to(step: int) -> tuple[str, str]:
        move = "slider.value = arguments[0]; slider.dispatchEvent(new Event('input'))"
        browser.execute_script(move, step)
        shown = browser.find_element(By.CSS_SELECTOR, "figure[data-floor='1'] figcaption").text
        return shown, browser.find_element(By.CSS_SELECTOR, ".moment.current strong").text

    assert go_to(1) == ("Floor 1 (start)", "Floor 1 (start)")
    stairs = "Up the stairs from floor 1 to floor 2 (3.0 m above the start)"
    assert go_to(3) == ("Floor 1 (start); the robot is on the stairs", stairs)
    assert go_to(1) == ("Floor 1 (start)", "Floor 1 (start)")


def test_the_script_knows_where_the_robot_was(
    steps: list[StepTrace], result: dict[str, Any], room: OccupancyGrid, tmp_path: Path
) -> None:
    data = player(read(write_page(tmp_path, result, steps, {1: room})))
    places = ("times", "steps", "modes", "reasons", "robots", "destinations")
    assert {len(data[name]) for name in places} == {len(steps)}
    (u0, v0, angle0), (u1, v1, angle1) = data["robots"][0], data["robots"][5]
    assert u1 > u0, "it went along x"
    assert v1 < v0, "and along y, which points up"
    assert angle1 < angle0, "and turned left, which the screen counts negative"
    assert data["times"] == sorted(data["times"])


def test_the_script_knows_which_step_decided_a_failure(
    steps: list[StepTrace], result: dict[str, Any], room: OccupancyGrid, tmp_path: Path
) -> None:
    assert player(read(write_page(tmp_path, result, steps, {1: room})))["decisive"] is None
    failed = result | {"success": False, "decisive_step": 3}
    assert player(read(write_page(tmp_path, failed, steps, {1: room})))["decisive"] == 3


def test_a_screen_reader_finds_the_content_and_a_name_for_each_column(
    steps: list[StepTrace], result: dict[str, Any], room: OccupancyGrid, tmp_path: Path
) -> None:
    text = write_page(tmp_path, result, steps, {1: room}).read_text(encoding="utf-8")
    assert text.count("<main") == text.count("</main>") == 1
    assert not re.search(r"<th[^>]*></th>", text)


@pytest.mark.parametrize("with_map", [True, False])
def test_an_episode_without_steps_or_result_has_a_page(
    with_map: bool, room: OccupancyGrid, tmp_path: Path
) -> None:
    page = read(write_page(tmp_path, {}, [], {1: room} if with_map else {}))
    assert "–" in page.visible
    assert len(page.with_tag("img")) == int(with_map)
    assert page.with_tag("video") == []


def test_an_empty_map_and_one_step_have_a_page(make_step: MakeStep, tmp_path: Path) -> None:
    nothing = OccupancyGrid(np.zeros((1, 1), dtype=np.uint8), 0.05, (0.0, 0.0))
    step = make_step(0, destination=None, path=[], seconds={}, reason="")
    page = read(
        write_page(tmp_path, {"outcome": "interrupted", "goal": "椅子"}, [step], {1: nothing})
    )
    assert "椅子" in page.texts["h1"]
    assert player(page)["destinations"] == [None]


def test_infinite_lengths_and_odd_results_have_a_page(
    steps: list[StepTrace], result: dict[str, Any], room: OccupancyGrid, tmp_path: Path
) -> None:
    result |= {"shortest_path_m": float("inf"), "distance_to_goal_m": None, "seconds": None}
    result |= {"success": False, "outcome": "unreachable", "detector": None, "config": None}
    page = read(write_page(tmp_path, result, steps, {1: room}))
    assert "No path to “bed”" in page.texts["h1"]
    assert "∞" in page.visible
    assert "None" not in page.visible


def test_long_answers_are_cut_and_told_in_full_below(
    make_step: MakeStep, result: dict[str, Any], room: OccupancyGrid, tmp_path: Path
) -> None:
    answer = "because of the kitchen " * 40
    asked = make_step(2)
    exchange = asked.exchanges[1].model_copy(update={"answer": answer})
    page = read(write_page(tmp_path, result, [make_step(2, exchanges=[exchange])], {1: room}))
    assert page.texts["blockquote"].count("because of the kitchen") == 40


def test_the_same_episode_gives_the_same_page(
    steps: list[StepTrace], result: dict[str, Any], room: OccupancyGrid, tmp_path: Path
) -> None:
    first = write_page(tmp_path / "a", result, steps, {1: room}).read_bytes()
    assert first == write_page(tmp_path / "b", result, steps, {1: room}).read_bytes()


def test_other_pages_can_stand_on_the_same_style_sheet() -> None:
    environment = page_environment()
    text = environment.from_string(
        '{% extends "base.html.j2" %}{% import "parts.html.j2" as parts with context %}'
        '{% block page %}<table><tr><td class="bar">{{ parts.bar(0.5, "series-2") }}</td></tr>'
        "</table>{{ name }}{% endblock %}"
    ).render(name="<b>")
    page = Page(text)
    assert "&lt;b&gt;" in text
    assert any(a.get("width") == "50.00%" for a in page.with_tag("rect"))
    defined = set(re.findall(r"--([\w-]+):", page.texts["style"]))
    used = set(re.findall(r"var\(--([\w-]+)\)", text))
    assert used <= defined
