"""The limits of the velocity, and what docs/robot.md says of them."""

import re
from pathlib import Path

from hypernav.robot.driving.driven_robot import CAREFUL
from hypernav.robot.driving.pure_pursuit import DriveConfig

PAGE = Path(__file__).parents[3] / "docs" / "robot.md"


def test_the_page_about_robots_has_every_limit_and_its_default():
    section = PAGE.read_text().partition("The fields of `DriveConfig`")[2].partition("\n## ")[0]
    written: dict[str, float] = {}
    for fields, defaults in re.findall(r"^\| (`.*?) \| (.*?) \|", section, re.MULTILINE):
        names = re.findall(r"`(\w+)`", fields)
        values = [float(value) for value in re.findall(r"\d[\d.]*", defaults.partition(";")[0])]
        written |= dict(zip(names, values, strict=True))
    assert written == DriveConfig().model_dump()
    assert f"0; {CAREFUL.margin_m} in `DrivenRobot`" in section
