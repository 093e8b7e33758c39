"""`hypernav doctor`: examine a vision-language model before relying on it."""

from rich.markup import escape

from hypernav.build.presets import preset
from hypernav.cli.doctor_options import Options
from hypernav.cli.terminal import Terminal
from hypernav.core.config import layered
from hypernav.core.errors import ConfigError
from hypernav.models.chat.vlm_spec import open_chat, parse_vlm_spec
from hypernav.perception.vlm_checkup import Finding, State, check_up

_MARKS = {
    State.GOOD: "[green]ok[/]   ",
    State.NOTE: "[yellow]note[/] ",
    State.FAULT: "[red]FAULT[/]",
}


def run(options: Options) -> int:
    """Run the command.

    Returns:
        0 if all is well, 1 if there is a fault.
    """
    spec = parse_vlm_spec(options.vlm)
    if spec.kind == "replay":
        raise ConfigError(f"--vlm {options.vlm}: a recording cannot be examined, only a model")
    config = layered(preset("default"), file=options.config, assignments=options.set)
    # A fault shall show now, not after two minutes of retries.
    chat = open_chat(spec, config.chat.model_copy(update={"patience_s": 0.0}))
    console = Terminal(stderr=False, soft_wrap=True)
    faults = []
    with console.status("asking the model …"):
        findings = check_up(
            chat, config.grounding, config.overview, config.block_choice, config.presence
        )
        for finding in findings:
            console.print(_line(finding))
            faults += [finding] if finding.state is State.FAULT else []
    if not faults:
        console.print("all is well")
        return 0
    console.print("what to change:")
    for fault in faults:
        console.print(f"  {fault.check}: {escape(fault.remedy)}")
    return 1


def _line(finding: Finding) -> str:
    return f"{_MARKS[finding.state]} {finding.check + ':':24} {escape(finding.said)}"
