"""The file ``exam.json`` of a model's exam, as far as searches use it.

`hypernav exam` writes it; a search takes from it what the model's answers are worth, which
questions are better not asked, and what they cost.
"""

from dataclasses import replace
from pathlib import Path
from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.core.config import Curve, ProbabilityCurve
from hypernav.core.errors import ConfigError
from hypernav.io.reading import read_file
from hypernav.search.models.chat.vlm_spec import parse_vlm_spec

AUTO = "auto"
"""The reasoner that an exam chooses."""
VERSION = 2


_Amount = Annotated[float, Field(ge=0.0, le=1e9)]
"""A mean number of something, or of seconds; none comes near the limit."""


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="ignore", allow_inf_nan=False)


class Calibration(_Part):
    """What is told, and what it is worth. A curve is empty if too few answers tell.

    Attributes:
        presence: Told and true probability that the goal is there, if it is there in half of all
            cases (`hypernav.search.perception.local.yes_no_checks.PresenceConfig.calibration`).
        boxes: Score of a box, and how much it shifts the log-odds that this is the goal
            (`hypernav.search.perception.config.LocalConfig.score_weights`).
    """

    presence: ProbabilityCurve = ()
    boxes: Curve = ()


class Predicted(_Part):
    """Searches of one preset.

    Attributes:
        preset: The preset.
        steps: Mean number of steps.
        asked: Mean number of questions of a search, by kind.
        asked_without: The same without asking about "block" or "presence".
        seconds: Mean processor time of a search without the model's, seconds.
        leave_out: Questions that are better not asked: "block", "presence".
    """

    preset: str
    steps: _Amount
    asked: dict[str, _Amount]
    asked_without: dict[Literal["block", "presence"], dict[str, _Amount]] = {}
    seconds: _Amount
    leave_out: tuple[Literal["block", "presence"], ...] = ()


class Cost(_Part):
    """What a question costs: means of all that it took.

    Attributes:
        calls: Number of calls of the model.
        seconds: Time of these calls, seconds.
        tokens_in: Number of prompt tokens.
        tokens_out: Number of answer tokens.
    """

    calls: _Amount
    seconds: _Amount
    tokens_in: _Amount
    tokens_out: _Amount


class ExamFile(_Part):
    """What searches take from an exam.

    Attributes:
        model: Name of the examined model, or of the components.
        who: Specifications of the components that were examined, by question.
        worth: What its answers are worth.
        predictions: What searches with it would be like; empty if that was not predicted.
        costs: What a question costs, by kind as in traces; empty without a model.
    """

    format: Literal["hypernav-exam"]
    version: Literal[2]
    model: str
    who: dict[str, str]
    worth: Calibration
    predictions: tuple[Predicted, ...] = ()
    costs: dict[str, Cost] = {}

    def check_is_of(self, specs: ComponentSpecs) -> None:
        """Refuse the exam of another model or detector than those that are to search.

        Raises:
            ConfigError: It is of another, or the model's name is not known.
        """
        if specs.vlm is not None:
            spec = parse_vlm_spec(specs.vlm)
            name = spec.model if spec.kind == "openai" else spec.target
            if name is None:
                raise ConfigError(
                    f"--exam is of {self.model}; name the model that the server has, so that both "
                    f"can be compared: --vlm {specs.vlm}#{self.model}"
                )
            if spec.kind != "replay" and name != self.model:
                raise ConfigError(f"--exam is of {self.model}, not of {name}; examine that as well")
        elif "model" in self.who:
            raise ConfigError(f"--exam is of {self.model}; name it with --vlm, or drop --exam")
        examined = self.who.get("boxes")
        asked = specs.detector or (None if specs.vlm is None else "vlm")
        if examined is not None and asked != examined:
            raise ConfigError(
                f"--exam examined the detector {examined}, and this search has "
                f"{asked or 'ground-truth'}; examine that, or choose --detector {examined}"
            )

    def predicted(self, preset: str) -> Predicted | None:
        """What searches with a preset are like; with "default" for those that nothing is said of.

        Returns:
            None if nothing was predicted.
        """
        by_preset = {one.preset: one for one in self.predictions}
        return by_preset.get(preset, by_preset.get("default"))

    def applied(self, config: HyPerNavConfig, *, unchecked: bool) -> HyPerNavConfig:
        """The configuration with what the answers are worth.

        Args:
            config: The configuration.
            unchecked: Whether the presence of the goal is not checked.

        Raises:
            ConfigError: The configuration says already what answers are worth.
        """
        if config.presence.calibration or config.local.score_weights:
            raise ConfigError(
                "--exam says what answers are worth, and so do presence.calibration and "
                "local.score_weights; leave one of the two out"
            )
        presence = {"calibration": self.worth.presence}
        presence |= {"enabled": False} if unchecked else {}
        local = {"score_weights": self.worth.boxes}
        return config.model_copy(
            update={
                "presence": config.presence.model_copy(update=presence),
                "local": config.local.model_copy(update=local),
            }
        )


def read_exam(path: Path) -> ExamFile:
    """Read an exam's file.

    Args:
        path: ``exam.json``, or its folder.

    Raises:
        ConfigError: It is missing, damaged, or of another version.
    """
    path = path / "exam.json" if path.is_dir() else path
    try:
        return ExamFile.model_validate_json(read_file(path))
    except OSError as error:
        raise ConfigError(
            f"--exam {path}: {error.strerror or error}; hypernav exam writes it"
        ) from error
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"])) or "the file"
        raise ConfigError(
            f"--exam {path} is no exam of this version, or damaged ({where}: {first['msg']}); "
            "the same hypernav exam writes a damaged one again without asking anything twice; for "
            "another version sit it anew, in another --out"
        ) from error


def without_auto(
    specs: ComponentSpecs, exam: ExamFile | None, preset: str
) -> tuple[ComponentSpecs, bool]:
    """The components with the reasoner that an exam chooses in place of "auto".

    Args:
        specs: Components; with another reasoner they stay as they are.
        exam: The exam, if there is one.
        preset: Preset of the search.

    Returns:
        The components, and whether the exam says not to check the presence of the goal.

    Raises:
        ConfigError: There is no exam, or it doesn't say; or "auto" is written otherwise.
    """
    if specs.reasoner != AUTO and (specs.reasoner or "").lower() == AUTO:
        raise ConfigError(f"unknown reasoner '{specs.reasoner}'; did you mean '{AUTO}'?")
    if specs.reasoner != AUTO:
        return specs, False
    predicted = None if exam is None else exam.predicted(preset)
    if predicted is None:
        raise ConfigError(
            "--reasoner auto does what an exam says: name one with a prediction, such as --exam "
            "runs/exam-…/exam.json"
        )
    examined = "geometric" if exam is None else exam.who.get("block", "geometric")
    reasoner = "geometric" if "block" in predicted.leave_out else examined
    return replace(specs, reasoner=reasoner), "presence" in predicted.leave_out
