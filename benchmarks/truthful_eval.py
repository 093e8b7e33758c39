"""Run `hypernav eval` with a chat model that tells the truth.

Methods that ask a chat model are measured without one by their stand-ins, and here by what they
would do if the model were always right: the scripted server of the tests answers every question
over a socket, from the simulator's ground truth. All options are those of `hypernav eval`.

    python benchmarks/truthful_eval.py houses-val --agent pivot --episodes 0:200 --out runs/pivot

Each worker process runs a server of its own, so there may be any number of workers. The server
knows what it is asked about without looking, so images stay black: drawing them would take three
quarters of the time.
"""

import sys
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))

from hypernav.app.build.agents import build_agent
from hypernav.app.build.built_agent import BuiltAgent
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.app.cli.main import main
from hypernav.lab.evaluation.workers import searcher
from servers.scripted import Asked, ScriptedServer
from servers.truth import Truth, TruthfulBrain, watching

MODEL = "openai:http://127.0.0.1:1/v1#truthful"
"""Name of the model in the run's folder; nothing listens there."""


class _ColourBlind(BuiltAgent):
    @property
    def looks_at_colours(self) -> bool:
        return False


def ask_the_truth(open_ones: ExitStack) -> None:
    """Run a server in this process, and build agents that ask it."""
    server = open_ones.enter_context(ScriptedServer())
    brain = TruthfulBrain(open_ones.enter_context(watching(Truth())))

    def answer(asked: Asked) -> str:
        server.requests.clear()  # of hundreds of episodes they would fill the memory
        return brain(asked)

    def build(config: HyPerNavConfig, specs: ComponentSpecs) -> BuiltAgent:
        return _ColourBlind(**vars(build_agent(config, replace(specs, vlm=server.spec))))

    server.brain = answer
    searcher.build_agent = build  # pyright: ignore[reportPrivateImportUsage]


if __name__ == "__main__":
    main(["eval", *sys.argv[1:], "--vlm", MODEL])
elif __name__ == "__mp_main__":  # a worker
    UNTIL_THE_END = ExitStack()
    ask_the_truth(UNTIL_THE_END)
