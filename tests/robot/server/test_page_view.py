"""The operator's page over a search of this program, asked as a browser asks."""

import json
import threading
import urllib.error
import urllib.request
from contextlib import closing

import pytest

from hypernav.app.build.agents import build_agent
from hypernav.app.show.video_frame import EpisodeInfo
from hypernav.core.geometry.transforms import Pose2
from hypernav.lab.episodes.episode_run import EpisodeRun
from hypernav.robot.server.page_view import PageView
from small_episodes import episode_from
from small_worlds import small_config, two_rooms


class Browser:
    """Requests as the page makes them."""

    def __init__(self, view):
        self.url = view.address.partition(" ")[0]

    def get(self, path):
        with urllib.request.urlopen(self.url + path, timeout=20) as response:
            return response.read()

    def json(self, path):
        return json.loads(self.get(path))

    def post(self, path, body):
        headers = {"content-type": "application/json"}
        request = urllib.request.Request(self.url + path, json.dumps(body).encode(), headers)
        with urllib.request.urlopen(request, timeout=20) as response:
            return json.loads(response.read())


@pytest.fixture
def stopped():
    """Set when someone has pressed STOP."""
    return threading.Event()


@pytest.fixture
def view(stopped):
    info = EpisodeInfo("bed", "hypernav", detector="ground truth", reasoner="geometric")
    with closing(PageView(info, stopped.set)) as view:
        yield view


@pytest.fixture
def browser(view):
    return Browser(view)


def steps_of(count):
    agent = build_agent(small_config()).agent
    run = EpisodeRun(agent, two_rooms(), episode_from(Pose2(2.5, 1.0, 0.0), max_steps=count))
    return iter(run)


def test_nobody_watches_before_a_page_has_asked(view, browser):
    assert b"<title>hypernav</title>" in browser.get("")
    assert not view.has_watcher()
    browser.json("v1/searches")
    assert view.has_watcher()


def test_the_page_sees_every_step_and_the_map_grow(view, browser):
    (search,) = browser.json("v1/searches")
    path, areas = f"v1/searches/{search['id']}", []
    for count, step in enumerate(steps_of(14), start=1):
        view.add(step.trace, step.grid, step.observation)
        status = browser.json(path)
        areas.append(status["map"]["rows"] * status["map"]["columns"])
        assert (status["next_sequence"], status["state"]) == (count, "waiting")
    assert areas[-1] > areas[0]
    lines = browser.get(f"{path}/trace?since=2").splitlines()
    assert [json.loads(line)["step"] for line in lines] == list(range(2, 14))
    assert browser.get(f"{path}/image?sequence=3").startswith(b"\xff\xd8")
    assert browser.get(f"{path}/map.png").startswith(b"\x89PNG")


def test_no_step_is_lost_of_a_robot_that_has_turned_around_before(view, browser):
    (search,) = browser.json("v1/searches")
    step = next(steps_of(1))
    for number in (11, 12):
        trace = step.trace.model_copy(update={"step": number})
        view.add(trace, step.grid, step.observation)
    path = f"v1/searches/{search['id']}/trace"
    for since, expected in ((0, [11, 12]), (12, [12]), (13, [])):
        lines = browser.get(f"{path}?since={since}").decode().splitlines()
        assert [json.loads(line)["step"] for line in lines] == expected


def test_a_page_that_waits_hears_of_the_next_step(view, browser):
    (search,) = browser.json("v1/searches")
    answers = []
    path = f"v1/searches/{search['id']}?after={search['version']}&wait_s=20"
    waiting = threading.Thread(target=lambda: answers.append(browser.json(path)))
    waiting.start()
    step = next(steps_of(1))
    view.add(step.trace, step.grid, step.observation)
    waiting.join(20)
    assert answers[0]["next_sequence"] == 1


@pytest.mark.parametrize("path", ["v1/stop", "v1/searches/{id}/stop"])
def test_stop_ends_the_search_and_stays_the_last_word(view, browser, stopped, path):
    (search,) = browser.json("v1/searches")
    assert not stopped.is_set()
    browser.post(path.format(id=search["id"]), {"reason": "enough"})
    assert stopped.is_set()
    view.finish({"goal": "bed", "outcome": "interrupted"})
    status = browser.json(f"v1/searches/{search['id']}")
    assert (status["state"], status["ending"], status["detail"]) == ("ended", "stopped", "enough")


@pytest.mark.parametrize(
    ("outcome", "ending", "detail"),
    [
        ("found", "found", ""),
        ("wrong_place", "found", "Stopped, but not at “bed”"),
        ("not_found", "gave up", "Did not find “bed”"),
        ("model_unavailable", "model unavailable", "Stopped: the model did not answer"),
        ("interrupted", "stopped", "Interrupted while looking for “bed”"),
    ],
)
def test_the_page_says_how_the_search_ended(view, browser, outcome, ending, detail):
    view.finish({"goal": "bed", "outcome": outcome, "success": outcome == "found"})
    (status,) = browser.json("v1/searches")
    assert (status["ending"], status["detail"]) == (ending, detail)


def test_another_search_and_another_host_are_refused(view, browser):
    with pytest.raises(urllib.error.HTTPError, match="404"):
        browser.get(f"v1/searches/{'0' * 32}")
    request = urllib.request.Request(browser.url, headers={"host": "elsewhere.example"})
    with pytest.raises(urllib.error.HTTPError, match="403"):
        urllib.request.urlopen(request, timeout=20)
