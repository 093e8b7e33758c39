import pytest
import yaml

from hypernav.app.build.config_values import config_schema, config_values, shown_value
from hypernav.app.build.presets import HyPerNavConfig, preset
from hypernav.core.embodiment import Embodiment, MotionConfig
from hypernav.core.errors import ConfigError
from hypernav.io.layered_config import layered
from hypernav.lab.evaluation.ablation.switches import values_by_field

VALUES = {value.key: value for value in config_values()}


def test_a_value_is_found_by_its_last_name() -> None:
    with pytest.raises(ConfigError, match=r"did you mean 'embodiment\.motion\.forward_m'"):
        config_values("forward_m")
    with pytest.raises(ConfigError, match=r"'forward_m' in the section 'embodiment\.motion'"):
        HyPerNavConfig().with_(forward_m=0.25)
    with pytest.raises(ConfigError, match=r"got '50cm' \(metres"):
        HyPerNavConfig().with_(embodiment={"motion": {"forward_m": "50cm"}})


def test_every_value_is_listed_once_with_its_default_in_both_presets():
    assert list(VALUES) == list(values_by_field(HyPerNavConfig()))
    assert {key: one.default for key, one in VALUES.items()} == values_by_field(preset("default"))
    assert {key: one.paper for key, one in VALUES.items()} == values_by_field(preset("paper"))


@pytest.mark.parametrize("key", VALUES)
def test_a_value_says_what_it_means_and_a_number_has_a_unit_and_a_range(key):
    value = VALUES[key]
    assert value.meaning.endswith((".", ")")) or value.meaning[0].isupper()
    assert value.range
    if isinstance(value.default, int | float) and not isinstance(value.default, bool):
        assert value.unit, "name the unit in the docstring, or in the field's name"
        assert " to " in value.range


@pytest.mark.parametrize(
    ("key", "unit", "possible", "source"),
    [
        ("search.endurance_steps", "steps", "whole, 1 to 1,000,000", "ours"),
        ("search.max_steps", "steps", "whole, 1 to 1,000,000", "paper"),
        ("planning.max_gap_m", "m", "0 to 50; or null", "measured"),
        ("planning.heading_tolerance_deg", "°", "above 0 to 180", "paper"),
        ("local.erosion_px", "px", "whole, 1 to 101", "ours"),
        ("world.stop_at", "", "first_wall, last_wall", "ours"),
        ("price.in_per_million", "currency", "0 to 1,000,000,000; or null", "ours"),
        ("prompted.most_moves", "moves", "whole, 1 to 100,000", "VLMnav"),
    ],
)
def test_units_ranges_and_sources(key, unit, possible, source):
    value = VALUES[key]
    assert (value.unit, value.range, value.source) == (unit, possible, source)


def test_a_shown_value_is_one_that_set_takes():
    assignments = [f"{value.key}={shown_value(value.default)}" for value in VALUES.values()]
    assert layered(preset("paper"), environment={}, assignments=assignments) == preset("default")


def test_a_section_a_part_of_it_and_a_single_value_can_be_asked_for():
    assert {one.section for one in config_values("search")} == {"search"}
    assert len(config_values("embodiment.body")) == 4
    assert [one.key for one in config_values("mapping.cell_size_m")] == ["mapping.cell_size_m"]


def test_a_mistyped_section_is_named_with_the_one_that_was_meant():
    with pytest.raises(ConfigError, match="no 'serach'; did you mean 'search'"):
        config_values("serach")
    with pytest.raises(ConfigError, match=r"did you mean 'search.endurance_steps'"):
        config_values("search.endurance_step")
    with pytest.raises(ConfigError, match=r"did you mean 'embodiment.camera'"):
        config_values("camera")
    with pytest.raises(ConfigError, match=r"did you mean 'embodiment.camera.hfov_deg'"):
        config_values("hfov")


def test_the_schema_describes_every_value_and_refuses_unknown_keys():
    schema = config_schema()

    def properties(part, prefix=""):
        part = schema["$defs"][part["$ref"].rpartition("/")[2]] if "$ref" in part else part
        if "properties" not in part:
            return
        assert part["additionalProperties"] is False
        assert "required" not in part
        for name, inner in part["properties"].items():
            assert inner["description"], f"{prefix}{name}"
            yield f"{prefix}{name}"
            yield from properties(inner, f"{prefix}{name}.")

    assert set(VALUES) <= set(properties(schema))


def test_with_changes_single_values_and_whole_sections():
    config = preset("default")
    changed = config.with_(
        search={"endurance_steps": 60},
        embodiment={"body": {"radius_m": 0.25}},
        mapping=config.mapping.model_copy(update={"cell_size_m": 0.1}),
    )
    differing = {
        key: value
        for key, value in values_by_field(changed).items()
        if value != values_by_field(config)[key]
    }
    assert differing == {
        "search.endurance_steps": 60,
        "embodiment.body.radius_m": 0.25,
        "mapping.cell_size_m": 0.1,
    }
    robot = Embodiment(motion=MotionConfig(forward_m=0.25))
    assert config.with_(embodiment=robot).embodiment == robot


@pytest.mark.parametrize(
    "assignment",
    ["serach.endurance_steps=60", "search.endurance_step=60", "search.endurance_steps=0"],
)
def test_with_says_what_set_says(assignment):
    section, _, rest = assignment.partition(".")
    key, _, number = rest.partition("=")
    with pytest.raises(ConfigError) as by_set:
        layered(preset("default"), environment={}, assignments=[assignment])
    with pytest.raises(ConfigError) as by_with:
        preset("default").with_(**{section: {key: yaml.safe_load(number)}})
    assert str(by_with.value) == str(by_set.value).replace(f"--set {assignment}", "with_")


def test_a_section_that_is_no_mapping_is_refused():
    with pytest.raises(ConfigError, match="'search' is a section with the keys"):
        preset("default").with_(search=60)


def test_a_mistyped_preset_is_named_with_the_one_that_was_meant():
    with pytest.raises(ConfigError, match="no preset 'defalt'; did you mean 'default'"):
        preset("defalt")
