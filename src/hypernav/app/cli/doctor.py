"""The command `hypernav doctor`: examine a vision-language model, or data."""

from collections.abc import Iterator

from rich.markup import escape

from hypernav.app.build.presets import preset
from hypernav.app.cli.options.commands import DoctorOptions
from hypernav.app.cli.screen.terminal import Terminal
from hypernav.core.errors import ConfigError
from hypernav.io.layered_config import layered
from hypernav.lab.evaluation.checks.data_folder import check_data
from hypernav.lab.evaluation.checks.findings import Finding, State
from hypernav.lab.evaluation.checks.vlm_checkup import check_up
from hypernav.lab.evaluation.run_cost import pace_words
from hypernav.search.models.chat.vlm_spec import open_chat, parse_vlm_spec

_MARKS = {
    State.GOOD: "[green]ok[/]   ",
    State.NOTE: "[yellow]note[/] ",
    State.FAULT: "[red]FAULT[/]",
}


def run(options: DoctorOptions) -> int:
    """Run the command.

    Returns:
        0 if all is well, 1 if there is a fault.

    Raises:
        ConfigError: Nothing to examine is named, or the model is a recording.
    """
    if options.vlm is None and options.data is None:
        raise ConfigError(
            "name what to examine: --vlm SPEC, a model, or --data DIR, a folder of benchmarks"
        )
    console = Terminal(stderr=False, soft_wrap=True)
    faults: list[Finding] = []
    settings: list[str] = []
    if options.data is not None:
        with console.status("reading the episodes …"):
            faults += _faults(_shown(check_data(options.data), console))
    if options.vlm is not None:
        findings = _check_model(options.vlm, options)
        with console.status("asking the model …"):
            shown = _shown(findings, console)
        faults += _faults(shown)
        settings = [finding.setting for finding in shown if finding.setting]
    if settings:
        told = f"use it with: --vlm {options.vlm} --set {' '.join(settings)}"
        console.print(told, markup=False)
    if not faults:
        if options.vlm is not None:
            told = (
                f"how far it will help a search, and where not: hypernav exam --vlm {options.vlm}"
            )
            console.print(told, markup=False)
        console.print("all is well")
        return 0
    console.print("what to change:")
    for line in dict.fromkeys(f"  {fault.check}: {escape(fault.remedy)}" for fault in faults):
        console.print(line)
    return 1


def _check_model(vlm: str, options: DoctorOptions) -> Iterator[Finding]:
    spec = parse_vlm_spec(vlm)
    if spec.kind == "replay":
        raise ConfigError(f"--vlm {vlm}: a recording cannot be examined, only a model")
    config = layered(preset("default"), file=options.config, assignments=options.set)
    # Report a fault at once, not after two minutes of retries.
    chat = open_chat(spec, config.chat.model_copy(update={"patience_s": 0.0}))
    return check_up(
        chat,
        config.grounding,
        config.overview,
        config.block_choice,
        config.presence,
        lambda seconds: pace_words(seconds, config),
    )


def _shown(findings: Iterator[Finding], console: Terminal) -> list[Finding]:
    """Print findings as they come, and return them."""
    shown = []
    for finding in findings:
        console.print(_line(finding))
        shown.append(finding)
    return shown


def _faults(findings: list[Finding]) -> list[Finding]:
    return [finding for finding in findings if finding.state is State.FAULT]


def _line(finding: Finding) -> str:
    return f"{_MARKS[finding.state]} {escape(finding.check + ':'):24} {escape(finding.said)}"
