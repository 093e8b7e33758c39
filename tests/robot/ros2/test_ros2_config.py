"""The file about a robot is checked key by key; the documented ones are valid."""

import re
from pathlib import Path

import pytest
import yaml

from hypernav.app.cli.main import main
from hypernav.core.errors import ConfigError
from hypernav.io.layered_config import layered
from hypernav.robot.ros2.config import Ros2Config

DOCS = Path(__file__).parents[3] / "docs" / "ros2.md"


def documented() -> list[str]:
    return re.findall(r"```yaml\n(.*?)```", DOCS.read_text(encoding="utf-8"), re.DOTALL)


@pytest.mark.parametrize("text", documented())
def test_the_documented_files_are_valid(text, tmp_path):
    (tmp_path / "ros2.yaml").write_text(text)
    layered(Ros2Config(), file=tmp_path / "ros2.yaml", environment={})


def test_the_documented_template_has_every_key_with_its_default():
    template = yaml.safe_load(documented()[0])
    assert template == Ros2Config().model_dump(exclude={"embodiment", "speed"}) | {
        name: template[name] for name in ("embodiment", "speed")
    }


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("topics: {color: /x}", "did you mean 'colour'"),
        ("timing: {fresh_s: 2.0}", "fresh_s"),
        ("cmd_vel_type: Twits", "Twist"),
        ("domain: 400", "domain"),
        ("topics: {nav2_lock: ''}", "nav2_lock"),
        ("topics: {stop_cmd_vel: /}", "stop_cmd_vel"),
        ("nav2: {still_m: 0.05}", "still_m 0.05 in still_s 0.3 is 0.166667 m/s.*at most 0.1 m/s"),
        ("nav2: {still_deg: 5}", "still_deg 5 in still_s 0.3 is .* at most 10 °/s"),
    ],
)
def test_a_mistake_is_named(text, message, tmp_path):
    (tmp_path / "ros2.yaml").write_text(text)
    with pytest.raises(ConfigError, match=message):
        layered(Ros2Config(), file=tmp_path / "ros2.yaml", environment={})


def test_the_domain_is_that_of_the_environment(monkeypatch):
    monkeypatch.setenv("ROS_DOMAIN_ID", "42")
    assert Ros2Config().domain_id == 42
    assert Ros2Config(domain=7).domain_id == 7
    monkeypatch.setenv("ROS_DOMAIN_ID", "many")
    with pytest.raises(ConfigError, match="ROS_DOMAIN_ID=many"):
        _ = Ros2Config().domain_id


def test_two_servers_are_a_mistake(capsys):
    with pytest.raises(SystemExit) as left:
        main(["robot", "ros2", "bed", "--server", "http://127.0.0.1:1", "--vlm", "local:x"])
    assert left.value.code == 2
    assert "--server" in capsys.readouterr().err


def test_it_drives_for_the_oldest_image_the_longest_command_and_its_own_reaction():
    assert Ros2Config().driving.reaction_s == pytest.approx(0.7)
    assignments = ["timing.fresh_s=0.3", "speed.max_speed_m_s=0.2"]
    config = layered(Ros2Config(), environment={}, assignments=assignments)
    assert (config.driving.reaction_s, config.driving.max_speed_m_s) == pytest.approx((0.6, 0.2))
    config = layered(Ros2Config(), environment={}, assignments=["speed.reaction_s=0.2"])
    assert config.driving.reaction_s == pytest.approx(0.9)
