"""The command `hypernav exam`: questions with known answers for a model, and a page about it."""

from collections.abc import Sequence
from contextlib import ExitStack, closing
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from hypernav.app.build.components.chat import model_words, wrap_chat
from hypernav.app.build.components.component_specs import ComponentSpecs, PresetName
from hypernav.app.build.components.fingerprints import prompt_hashes
from hypernav.app.build.presets import HyPerNavConfig, preset
from hypernav.app.cli.evaluation.eval import folder_name
from hypernav.app.cli.guards.outputs import check_folder
from hypernav.app.cli.options.commands import ExamOptions
from hypernav.app.cli.screen.counter import Counter
from hypernav.app.cli.screen.search_lines import warnings_on
from hypernav.app.cli.screen.terminal import Terminal
from hypernav.core.components.protocols import ChatModel
from hypernav.core.config import MOST_THREADS, check_option
from hypernav.core.errors import ConfigError
from hypernav.io.folder_lock import folder_lock
from hypernav.io.layered_config import layered
from hypernav.lab.exam.bank import BANK_VERSION, Bank
from hypernav.lab.exam.examinee import Examinee, check_named
from hypernav.lab.exam.gathering import questions_of
from hypernav.lab.exam.prediction.confusion import confusion_of
from hypernav.lab.exam.prediction.network_scores import measure
from hypernav.lab.exam.prediction.outlook import Prediction, predictions_of
from hypernav.lab.exam.prediction.searches import SEARCHES, mimics_of, run_searches, spread_episodes
from hypernav.lab.exam.questions import Answered
from hypernav.lab.exam.results import (
    PAGE,
    RESULT,
    Examined,
    differences_of,
    write_comparison,
    write_results,
)
from hypernav.lab.exam.sitting import FORECAST_AFTER, Progress, nameless_of, sit
from hypernav.search.models.chat.ledger import Ledger
from hypernav.search.models.chat.vlm_spec import parse_vlm_spec
from hypernav.search.models.onnx_detector import OnnxDetector
from hypernav.search.models.reliability import write_reliability

_AT_ONCE = 4
_WAITS = {"timeout_s", "patience_s", "first_wait_s", "longest_wait_s", "device"}
"""Values that say how long and where, not what is answered."""
_PREDICTED: tuple[PresetName, ...] = ("default", "paper")
"""Presets of the searches that are predicted."""
_DRAWN = ("embodiment", "mapping", "overview", "arrows")
"""Sections on which the questions themselves depend."""
EXCHANGES = "exchanges.jsonl"
_GO_ON = "Run the same command again to go on"


def run(options: ExamOptions) -> int:
    """Run the command.

    Returns:
        The status of success: every question is answered, well or badly.

    Raises:
        HyPerNavError: The exam cannot be begun, or stopped before its end; the same command goes
            on from there.
    """
    if options.at_once is not None:
        check_option("--at-once", options.at_once, (1, MOST_THREADS), "questions at a time")
    check_option("--predict", options.predict, (0, 1000), "episodes")
    if options.compare is not None and options.config is not None:
        raise ConfigError("--compare names the two files; drop --config")
    if options.calibrate:
        return _calibrate(options)
    folder = options.out or Path("runs") / folder_name(f"exam-{_name(options)}")
    check_folder(folder)
    console = Terminal(soft_wrap=True)
    if options.compare is None:
        answers, page = _examined(options, options.config, folder, console)
        right = sum(one.score for one in answers)
        said = f"{right:.0f} of {len(answers)} answers are right; the page: {page}"
        console.print(said, markup=False)
        return 0
    first, second = (  # both now: a bad second file is not found out after a whole exam
        layered(preset(options.preset), file=path, assignments=options.set)
        for path in options.compare
    )
    if other := [one for one in _DRAWN if getattr(first, one) != getattr(second, one)]:
        raise ConfigError(
            f"--compare: the two files differ in {', '.join(other)}, so their questions would "
            "differ, too; compare files that differ in words and answers only"
        )
    names = (options.compare[0].stem, options.compare[1].stem)
    parts = [
        _examined(options, path, folder / part, console)[0]
        for part, path in zip(("first", "second"), options.compare, strict=True)
    ]
    page = write_comparison(folder, names, differences_of(*parts))
    console.print(f"the comparison: {page}", markup=False)
    return 0


def _calibrate(options: ExamOptions) -> int:
    """Measure what a network's scores are worth, and keep it beside the network."""
    config = layered(preset(options.preset), file=options.config, assignments=options.set)
    examinee = Examinee(config, ComponentSpecs(detector=options.detector), None)
    examinee.check()
    detector = examinee.detector
    if not isinstance(detector, OnnxDetector):
        raise ConfigError(
            "--calibrate measures one network of a closed list: name it with --detector "
            "yolox:FILE, yolov8:FILE or picodet:FILE; of other detectors an exam without "
            "--calibrate tells what scores are worth (exam.json)"
        )
    console = Terminal(soft_wrap=True)
    measured = measure(detector, config, options.size, lambda scene: console.print(scene))
    path = write_reliability(detector.path, measured)
    console.print(
        f"{measured.images} images: {measured.right} things named rightly, {measured.alike} taken "
        f"for something else, {measured.nothing} boxes around nothing; searches with "
        f"{detector.name} now use {path}",
        markup=False,
    )
    return 0


def _examined(
    options: ExamOptions, file: Path | None, folder: Path, console: Terminal
) -> tuple[list[Answered], Path]:
    """Sit one exam and write its page."""
    config = layered(preset(options.preset), file=file, assignments=options.set)
    specs = ComponentSpecs(
        vlm=options.vlm,
        detector=options.detector,
        reasoner=options.reasoner,
        segmenter=options.segmenter,
    )
    check_named(specs)
    is_replay = options.vlm is not None and parse_vlm_spec(options.vlm).kind == "replay"
    record = None if options.vlm is None or is_replay else folder / EXCHANGES
    with folder_lock(folder), warnings_on(console), ExitStack() as stack:
        chat, recording = wrap_chat(options.vlm, config.chat, Ledger(), record, resume=True)
        if recording is not None:
            stack.enter_context(closing(recording))
        examinee = Examinee(config, specs, chat)
        examinee.check()
        bank = Bank(options.bank, options.size, examinee.kinds)
        examined = _described(options, config, bank, examinee, chat)
        answers = _watched(options, config, folder, bank, examinee, examined, console)
        examined = replace(examined, nameless=nameless_of(folder))
        if examined.nameless.words:
            console.print(examined.nameless.words, markup=False)
        predicts = options.predict > 0 and options.compare is None
        page = folder / PAGE
        if not predicts or not (folder / RESULT).exists():  # before minutes of searches
            page = write_results(folder, examined, answers)
        if predicts:
            predictions = _predicted(options, config, folder, examinee, answers, console)
            page = write_results(folder, examined, answers, predictions)
        return answers, page


def _predicted(
    options: ExamOptions,
    config: HyPerNavConfig,
    folder: Path,
    examinee: Examinee,
    answers: Sequence[Answered],
    console: Terminal,
) -> list[Prediction]:
    """What searches with the model would reach; nothing if no such question was asked."""
    confusion = confusion_of(answers)
    if not (confusion.blocks or confusion.sight or confusion.presence):
        return []
    robot = {"embodiment": config.embodiment, "mapping": config.mapping}
    configs = {name: preset(name).model_copy(update=robot) for name in _PREDICTED}
    configs |= {options.preset: config} if options.preset in configs else {}
    configs = {
        name: one.model_copy(update={"local": one.local.for_detector(examinee.detector)})
        for name, one in configs.items()
    }
    console.print(f"searching {options.predict} times with stand-ins that err like it …")
    episodes = spread_episodes(config, options.predict)
    words = f"of {len(episodes)} searches with stand-ins"
    with Counter(console, f"the first {words}") as counter:
        agents = mimics_of(confusion, configs)
        try:
            searches = run_searches(
                agents,
                config,
                episodes,
                folder / SEARCHES,
                lambda done: counter.update(f"{done} {words}"),
            )
        except KeyboardInterrupt:
            console.print(f"the searches so far are kept in {folder}. {_GO_ON}", markup=False)
            raise
    return predictions_of(searches)


def _watched(
    options: ExamOptions,
    config: HyPerNavConfig,
    folder: Path,
    bank: Bank,
    examinee: Examinee,
    examined: Examined,
    console: Terminal,
) -> list[Answered]:
    with Counter(console, "making the first questions") as counter:

        def watch(progress: Progress) -> None:
            line = _line(progress, config)
            counter.update(line)
            if progress.answered_here == FORECAST_AFTER:
                console.print(f"after the first ten: {line}", markup=False)

        def stop(under_way: int) -> None:
            waits = f"waiting for {under_way} answers under way; " if under_way else ""
            console.print(
                f"{waits}all answers are kept in {folder}. {_GO_ON}",
                markup=False,
            )

        return sit(
            folder,
            bank,
            partial(questions_of, config=config),
            examinee,
            configuration=_configuration(examined, config),
            at_once=options.at_once or (_AT_ONCE if _is_served(options) else 1),
            watch=watch,
            stop=stop,
        )


def _described(
    options: ExamOptions,
    config: HyPerNavConfig,
    bank: Bank,
    examinee: Examinee,
    chat: ChatModel | None,
) -> Examined:
    who = {kind: examinee.words(kind) for kind in examinee.kinds}
    if options.vlm is not None and chat is not None:
        who["model"] = model_words(options.vlm, chat.identify)
    return Examined(
        model=_name(options) if chat is None else chat.identify(),
        family=config.grounding.family,
        bank=f"{bank.name}, {bank.size}, version {BANK_VERSION}",
        wanted=bank.count,
        who=who,
        prompts=prompt_hashes(config) if options.vlm else {},
        price_in_per_million=config.price.in_per_million,
        price_out_per_million=config.price.out_per_million,
    )


def _configuration(examined: Examined, config: HyPerNavConfig) -> dict[str, Any]:
    return {
        "model": examined.model,
        "bank": examined.bank,
        "who": examined.who,
        "prompts": examined.prompts,
        "config": config.model_dump(mode="json", exclude={"price": True, "chat": _WAITS}),
    }


def _line(progress: Progress, config: HyPerNavConfig) -> str:
    line = f"{progress.done} of {progress.wanted} questions"
    if progress.left_s is not None:
        line += f", about {max(round(progress.left_s / 60.0), 1)} min left"
    cost = progress.cost(config.price.in_per_million, config.price.out_per_million)
    return line if cost is None else f"{line}, about {cost:.3g} in money for the whole exam"


def _name(options: ExamOptions) -> str:
    if options.vlm is not None:
        spec = parse_vlm_spec(options.vlm)
        return spec.model or spec.target
    named = (options.detector, options.segmenter, options.reasoner)
    return " ".join(one for one in named if one) or "nothing"


def _is_served(options: ExamOptions) -> bool:
    return options.vlm is not None and parse_vlm_spec(options.vlm).kind == "openai"
