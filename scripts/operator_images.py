"""Take the images of the operator's page: a search that is over, and the remembered things.

Run: python scripts/operator_images.py

A server with a memory and a robot that waits in the built-in house run while a browser without a
window works the page as an operator does. Chromium and chromedriver must be installed.
"""

import contextlib
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from selenium import webdriver
from selenium.common.exceptions import NoSuchElementException, StaleElementReferenceException
from selenium.webdriver.common.by import By
from selenium.webdriver.remote.webelement import WebElement
from selenium.webdriver.support.ui import WebDriverWait

_IMAGES = Path(__file__).parents[1] / "docs" / "images"
_PORT = 8799
_ADDRESS = f"http://127.0.0.1:{_PORT}"
_SERVE = ("serve", "--port", str(_PORT), "--state", "state")
_WAIT = ("robot", "wait", "--server", _ADDRESS, "--name", "anna", "--quiet")
_START = ("--start", "-2.545", "-1.770", "82.28")
"""The start of ``hypernav find bed --seed 2``."""
_STEP = 20
"""The step that is looked at, from 0: a block was chosen, and the goal is not in view."""
_WIDTH_PX = 1000
_SHORTENED = """
for (const part of [".head", "[aria-labelledby=timeline-title]"])
  document.querySelector(part).style.display = "none";
arguments[0].scrollIntoView({block: "center"});
"""
_PATIENCE_S = 300.0
_NOT_YET = (NoSuchElementException, StaleElementReferenceException)


def main() -> None:
    """Write the images."""
    with _browser() as page:
        with _running():
            _find(page, "bed")
            page.execute_script(
                "const slider = document.getElementById('slider'); slider.value = arguments[0];"
                "slider.dispatchEvent(new Event('input'))",
                _STEP,
            )
            _take(page, "operator-page", 1420)
        with _running("--memory", "home"):
            _find(page, "bed")
            _until(page, lambda: _button(page, "sofa").is_enabled())
            _button(page, "sofa").click()
            _until(page, lambda: _headline(page) == "Found “sofa”")
            _until(page, lambda: _button(page, "sofa").is_enabled())
            page.execute_script(_SHORTENED, _button(page, "sofa"))
            _take(page, "operator-things", 1150)


@contextlib.contextmanager
def _browser() -> Iterator[webdriver.Chrome]:
    options = webdriver.ChromeOptions()
    for argument in ("headless=new", "no-sandbox", "disable-gpu", "hide-scrollbars"):
        options.add_argument(f"--{argument}")
    page = webdriver.Chrome(options, webdriver.ChromeService(shutil.which("chromedriver")))
    try:
        yield page
    finally:
        page.quit()


@contextlib.contextmanager
def _running(*options: str) -> Iterator[None]:
    """A server, and a robot that waits for goals."""
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as ends:
        for command in ((*_SERVE, *options), (*_WAIT, *_START)):
            program = subprocess.Popen([sys.executable, "-m", "hypernav", *command], cwd=folder)
            ends.callback(program.wait)
            ends.callback(program.terminate)
            time.sleep(5.0)
        yield


def _until(page: webdriver.Chrome, is_so: Callable[[], object]) -> None:
    WebDriverWait(page, _PATIENCE_S, 0.2, _NOT_YET).until(lambda _: is_so())


def _find(page: webdriver.Chrome, goal: str) -> None:
    page.get(_ADDRESS)
    _until(page, page.find_element(By.ID, "send").is_enabled)
    page.find_element(By.ID, "goal").send_keys(goal)
    page.find_element(By.ID, "send").click()
    _until(page, lambda: _headline(page) == f"Found “{goal}”")


def _headline(page: webdriver.Chrome) -> str:
    return page.find_element(By.ID, "headline").text


def _button(page: webdriver.Chrome, label: str) -> WebElement:
    """The button that sends a robot to the first thing with a label."""
    return page.find_element(By.CSS_SELECTOR, f"#things button[aria-label^='Go to the {label} ']")


def _take(page: webdriver.Chrome, name: str, height_px: int) -> None:
    size = {"width": _WIDTH_PX, "height": height_px, "deviceScaleFactor": 1, "mobile": False}
    page.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    page.execute_script("scrollTo(0, 0)")
    time.sleep(2.0)  # until everything is drawn
    page.save_screenshot(str(_IMAGES / f"{name}.png"))


if __name__ == "__main__":
    main()
