"""Native mode, and the mistakes of released code, as configurations."""

import pytest

from hypernav.app.build.agents import build_agent
from hypernav.app.build.components.choosing import choose_components
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.native import native_config, step_limit_of
from hypernav.app.build.presets import HyPerNavConfig, preset
from hypernav.app.cli.command_line import run_command
from hypernav.app.cli.options.agent import AgentOptions
from hypernav.core.errors import ConfigError
from hypernav.lab.datasets.benchmarks import BENCHMARKS
from hypernav.search.rivals.arrows.proposals import MOST_MOVE_M
from hypernav.search.rivals.config import ArrowsConfig

NATIVE = ("vlfm", "navvlm", "vlmnav", "pivot")


@pytest.mark.parametrize("agent", NATIVE)
def test_goals_count_as_reached_where_they_do_in_common_mode(agent):
    config = native_config(agent, HyPerNavConfig())
    assert config.world.judge_eye_m == HyPerNavConfig().embodiment.camera.height_m
    assert config.embodiment.body == HyPerNavConfig().embodiment.body


@pytest.mark.parametrize(
    ("agent", "hfov", "height", "step", "sliding"),
    [
        ("vlfm", 79.0, 0.88, 0.25, False),
        ("navvlm", 90.0, 1.1, 0.3, True),
        ("vlmnav", 131.0, 1.5, 0.17, True),
        ("pivot", 131.0, 1.5, 0.17, True),
    ],
)
def test_every_method_has_its_own_robot_on_every_benchmark(agent, hfov, height, step, sliding):
    for base in (HyPerNavConfig(), HyPerNavConfig(embodiment=BENCHMARKS["ovon"].embodiment)):
        config = native_config(agent, base)
        camera, motion = config.embodiment.camera, config.embodiment.motion
        assert (camera.hfov_deg, camera.height_m) == (hfov, height)
        assert camera.width > camera.height
        assert (motion.forward_m, config.world.sliding) == (step, sliding)


def test_no_forty_moves_take_more_steps_than_the_limit():
    config = native_config("vlmnav", HyPerNavConfig())
    motion, prompted = config.embodiment.motion, config.prompted
    longest = 180.0 / motion.turn_angle_deg + MOST_MOVE_M / motion.forward_m
    assert prompted.most_moves * (longest + 1) + 1 <= step_limit_of("vlmnav")


@pytest.mark.parametrize("agent", ["hypernav", "frontier", "dynavlm-style"])
def test_without_a_robot_of_its_own_there_is_no_native_mode(agent):
    with pytest.raises(ConfigError, match="no robot or stop of its own"):
        AgentOptions(agent=agent, native=True).resolve()
    with pytest.raises(ConfigError, match="no robot or stop of its own"):
        choose_components(ComponentSpecs(agent=agent, native=True))


def test_native_agents_are_refused_on_the_robot_of_common_mode():
    specs, common = ComponentSpecs(agent="vlmnav", native=True), preset("default")
    with pytest.raises(ConfigError, match=r"hypernav\.native_config"):
        build_agent(common, specs)
    built = build_agent(native_config("vlmnav", common), specs)
    assert built.chosen.as_dict()["mode"] == "native"


@pytest.mark.parametrize("command", [["serve"], ["robot", "replay", "bag"]])
def test_a_robot_and_a_recording_have_no_native_mode(command):
    with pytest.raises(ConfigError, match="Unrecognized options: --native"):
        run_command([*command, "--agent", "vlmnav", "--native"])


def test_native_agents_are_called_so_wherever_they_are_named():
    options = AgentOptions(agent="vlmnav", native=True)
    told = options.describe(options.build())
    assert told["agent"] == options.name == "vlmnav (native)"
    assert told["parts"]["mode"] == "native"
    common = AgentOptions(agent="vlmnav")
    assert "mode" not in common.describe(common.build())["parts"]


def test_values_of_the_user_lie_over_those_of_native_mode():
    options = AgentOptions(agent="navvlm", native=True, set=("embodiment.camera.height_m=1.2",))
    assert options.resolve().embodiment.camera.height_m == 1.2


@pytest.mark.parametrize("agent", ["vlmnav", "pivot"])
def test_methods_that_ask_to_stop_have_no_detector(agent):
    assert choose_components(ComponentSpecs(agent=agent, native=True)).detector is None
    with pytest.raises(ConfigError, match="asks no detector"):
        choose_components(ComponentSpecs(agent=agent, native=True, detector="ground-truth"))


def test_mistakes_are_off_unless_a_preset_of_released_code_is_asked_for():
    default = preset("default")
    assert default.arrows.space_explored
    assert not default.search.claim_when_explored
    assert not default.navvlm.clear_rows
    assert default.arrows == ArrowsConfig(zero_is_last=False, count_short=False)
    assert preset("vlfm-as-released").search.claim_when_explored
    assert preset("navvlm-as-released").navvlm.clear_rows
    assert not preset("vlmnav-as-released").arrows.space_explored
    assert preset("pivot-as-released").arrows.zero_is_last


def test_the_mistakes_of_another_method_are_refused():
    with pytest.raises(ConfigError, match="for --agent vlfm"):
        AgentOptions(agent="pivot", preset="vlfm-as-released").resolve()
