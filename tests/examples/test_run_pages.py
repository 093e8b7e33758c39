"""What `scripts/run_pages.py` says of blocks that it can't run."""

import importlib
from pathlib import Path

import pytest

SCRIPTS = Path(__file__).parents[2] / "scripts"
REASON = "<!-- not run: it takes hours -->"


@pytest.fixture
def check(monkeypatch):
    """The faults of a page of some blocks, each after the line of its block."""
    monkeypatch.syspath_prepend(str(SCRIPTS))
    run_pages = importlib.import_module("run_pages")

    def faults(*blocks: str) -> list[str]:
        return list(run_pages.faults_of_unrun("# A page\n\n" + "\n\n".join(blocks) + "\n"))

    return faults


def test_commands_that_exist_and_say_why_they_are_not_run_are_fine(check):
    commands = (
        "for kind in houses shops; do\n"
        "  hypernav eval $kind-val \\\n    --agent frontier  # hours\n"
        "done; hypernav report runs/* --compare | head &\nsome other --program\n"
        "python benchmarks/houses.py --first 3 --count 2\nmake demo"
    )
    python = "import hypernav\nfrom hypernav import Goal\n\nhypernav.find(mine)"
    assert not check(
        f"{REASON}\n```bash\n{commands}\n```",
        f"{REASON}\n```python\n{python}\n```",
        "```\nobservation -> decide -> action\n```",
        "```yaml\nhypernav: 1\n```",
        "```sh\nit would be run\n```",
    )


@pytest.mark.parametrize("language", ["", "bash"])
def test_commands_without_a_reason_are_a_fault(language, check):
    block = f"```{language}\nhypernav find bed\n```"
    (fault,) = check(block)
    assert fault.startswith("3: neither run nor marked")
    assert not check("<!-- commands are not run: they take hours -->", block)


def test_what_was_renamed_is_a_fault_where_it_is_not_run(check):
    wrong = {
        "hypernav eval houses-val --agnet frontier": "Unrecognized options: --agnet",
        "hypernav find bed --set search.endurance=60": "search.endurance",
        "hypernav eval house-val": "house-val",
        "hypernav finds bed": "unknown command 'finds'",
        "hypernav eval houses-val --preset papers": "papers",
        "python benchmarks/hoses.py": "there is no such file",
        "python benchmarks/houses.py --furst 3": "it has no --furst",
        "python benchmarks/truthful_eval.py houses-val --agnet pivot": "--agnet",
        "make dmo": "no such target",
        'hypernav find "bed': "a quotation has no end",
    }
    faults = check(f"{REASON}\n```sh\n" + "\n".join(wrong) + "\n```")
    assert len(faults) == len(wrong)
    for fault, (command, words) in zip(faults, wrong.items(), strict=True):
        assert command.replace('"', "").split()[1] in fault
        assert words in fault


def test_python_that_is_not_run_is_read(check):
    text = "import hypernav\nfrom hypernav import Gaol\n\nhypernav.fnd('bed')"
    faults = check(
        f"{REASON}\n```python\n{text}\n```",
        f"{REASON}\n```python\nif True\n```",
    )
    assert [fault.partition(": ")[2] for fault in faults[:2]] == [
        "hypernav has no Gaol",
        "hypernav has no fnd",
    ]
    assert "no Python" in faults[2]


def test_what_was_renamed_is_a_fault_in_a_sentence_that_may_leave_out_the_rest(check):
    assert not check(
        "Look at `hypernav eval --plan`, `hypernav doctor --vlm`, `hypernav COMMAND --help`,",
        "`python benchmarks/houses.py --first …` or `make demo`.",
    )
    renamed = "hypernav eval --plam", "hypernav evil", "python scripts/a.py", "make dmo"
    faults = check("Some words first.", *(f"Look at `{one}`." for one in renamed))
    assert [fault.partition(": ")[0] for fault in faults] == ["5", "7", "9", "11"]
