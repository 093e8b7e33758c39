"""What components are given in files is known by its content."""

from dataclasses import replace
from pathlib import Path

from hypernav.app.build.components.choosing import choose_components
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.app.build.components.fingerprints import digests, given_files
from hypernav.app.build.presets import HyPerNavConfig
from hypernav.app.cli.options.agent import AgentOptions


def written(folder: Path, name: str) -> Path:
    path = folder / name
    path.write_bytes(name.encode())
    return path


def test_weights_and_vectors_are_files_that_components_are_given(tmp_path):
    weights, goals = written(tmp_path, "zson.safetensors"), written(tmp_path, "goals.safetensors")
    config = HyPerNavConfig().with_(policy={"goals": str(goals)})
    zson = choose_components(ComponentSpecs(agent=f"zson:{weights}"))
    assert given_files(zson, config) == (weights, goals)
    yolox = choose_components(ComponentSpecs(detector=f"yolox:{weights}"))
    assert given_files(yolox, config) == (weights,)
    beside = written(tmp_path, f"{weights.name}.reliability.json")
    assert given_files(yolox, config) == (weights, beside)
    both = choose_components(ComponentSpecs(detector=f"yolox:{weights}+picodet:{goals}"))
    assert given_files(both, config) == (weights, goals, beside)
    noisy = choose_components(ComponentSpecs(detector="noisy:0.7"))
    assert given_files(noisy, config) == ()


def test_a_replaced_file_is_another_file(tmp_path):
    path = written(tmp_path, "weights")
    before = digests([path])
    assert digests([path]) == before
    path.write_bytes(b"other weights")
    assert digests([path]) != before


def test_a_run_remembers_the_files_of_its_components(tmp_path):
    path, options = written(tmp_path, "weights"), AgentOptions()
    built = options.build()
    assert "files" not in options.describe(built)
    assert options.describe(replace(built, files=(path,)))["files"] == digests([path])
