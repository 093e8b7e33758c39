import pytest

from hypernav.core.config import RoomConfig
from hypernav.core.errors import ConfigError
from hypernav.io.layered_config import layered


class Motor(RoomConfig):
    speed_m_s: float = 0.5
    wheels: int = 4


class Robot(RoomConfig):
    motor: Motor = Motor()
    name: str = "r2"


def configured(**layers):
    return layered(Robot(), environment=layers.pop("environment", {}), **layers)


def test_later_layers_win(tmp_path):
    file = tmp_path / "robot.yaml"
    file.write_text("motor: {speed_m_s: 1.0, wheels: 2}\nname: wall-e\n")
    config = configured(
        file=file,
        environment={"HYPERNAV_MOTOR__WHEELS": "3", "HYPERNAV_TEST_DATA": "x", "PATH": "y"},
        assignments=["motor.speed_m_s=2"],
    )
    assert config == Robot(motor=Motor(speed_m_s=2.0, wheels=3), name="wall-e")


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_a_file_of_windows_is_read(encoding, tmp_path):
    file = tmp_path / "robot.yaml"
    file.write_bytes("name: wall-e\r\nmotor:\r\n  wheels: 2\r\n".encode(encoding))
    assert configured(file=file) == Robot(motor=Motor(wheels=2), name="wall-e")


def test_an_empty_file_changes_nothing(tmp_path):
    (tmp_path / "empty.yaml").write_text("")
    assert configured(file=tmp_path / "empty.yaml") == Robot()


def test_configuration_cannot_be_changed_afterwards():
    with pytest.raises(ValueError, match="frozen"):
        Robot().name = "other"


@pytest.mark.parametrize(
    ("assignment", "words"),
    [
        ("motor.sped_m_s=1", "did you mean 'speed_m_s'.*speed_m_s, wheels"),
        ("wings=2", "unknown key 'wings'.*motor, name"),
        ("wheel=2", "unknown key 'wheel'; did you mean 'wheels' in the section 'motor'"),
        ("motor=5", "'motor' is a section"),
        ("motor.wheels=yes", "'wheels' is a number, got True"),
        ("motor.speed_m_s", "expected SECTION.KEY=VALUE"),
        ("motor.speed_m_s=fast", "motor.speed_m_s: .*number.*'fast'"),
    ],
)
def test_a_wrong_assignment_says_what_is_right(assignment, words):
    with pytest.raises(ConfigError, match=words):
        configured(assignments=[assignment])


@pytest.mark.parametrize(
    ("content", "words"), [("a: [", "not valid YAML"), ("- 1\n- 2\n", "must hold sections")]
)
def test_a_broken_file_is_named(tmp_path, content, words):
    file = tmp_path / "broken.yaml"
    file.write_text(content)
    with pytest.raises(ConfigError, match=rf"broken.yaml.*{words}"):
        configured(file=file)


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(ConfigError, match=r"nowhere.yaml: No such file"):
        configured(file=tmp_path / "nowhere.yaml")


@pytest.mark.parametrize("text", ["[1", "@nonsense", "{a"])
def test_a_value_that_is_no_yaml_is_refused_with_the_reason(text):
    with pytest.raises(ConfigError, match="is not valid YAML"):
        configured(assignments=[f"motor.wheels={text}"])
