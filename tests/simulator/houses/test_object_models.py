from pathlib import Path

import numpy as np
import pytest

from hypernav.simulator.houses.modelling.materials import sample_palette
from hypernav.simulator.houses.modelling.model import Model
from hypernav.simulator.houses.objects.catalogue import all_makers
from hypernav.simulator.houses.random_stream import RandomStream
from hypernav.simulator.houses.textures.library import texture

MAKERS = all_makers()
SEEDS = range(2)
HANGING = ("ceiling lamp", "chandelier", "projector")


def make(name: str, seed: int) -> Model:
    rng = RandomStream(seed, name)
    return MAKERS[name](rng, sample_palette(rng.fork("taste")))


@pytest.mark.slow
def test_the_page_counts_models_and_kinds_rightly():
    kinds = {make(name, seed).category for name in MAKERS for seed in range(5)}
    page = Path(__file__).parents[3] / "docs/houses.md"
    assert f"The generator has {len(MAKERS)} models of {len(kinds)} kinds" in page.read_text()


@pytest.mark.parametrize("name", MAKERS)
def test_every_model_is_whole_centred_and_named(name: str):
    for seed in SEEDS:
        model = make(name, seed)
        points = np.concatenate([p.mesh.positions for p in model.parts])
        normals = np.concatenate([p.mesh.normals for p in model.parts])
        low, high = points.min(axis=0), points.max(axis=0)
        assert np.isfinite(points).all()
        assert np.allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-3)
        assert np.allclose(low, model.low, atol=1e-9)
        assert np.allclose(high, model.high, atol=1e-9)
        assert np.allclose((low + high)[:2], 0.0, atol=1e-9)
        assert (high - low).max() < 2.7
        if model.category in HANGING:
            assert high[2] <= 1e-9
        else:
            assert -0.03 <= low[2] <= 0.05
        assert sum(len(p.mesh.faces) for p in model.parts) <= 12_000
        assert model.category == model.category.lower().strip() != ""
        assert model.category not in model.synonyms
        for top in model.supports:
            assert low[0] <= top.x_min < top.x_max <= high[0]
            assert low[1] <= top.y_min < top.y_max <= high[1]
            assert 0.0 < top.z <= high[2] + 0.02
        for part in model.parts:
            assert part.mesh.faces.max() < len(part.mesh.positions)
            assert part.finish.texture == "" or texture(part.finish.texture).size > 0
            assert all(0.0 <= c <= 1.0 for c in part.finish.color)


@pytest.mark.parametrize("name", list(MAKERS)[::6])
def test_equal_streams_make_equal_models(name: str):
    one, two = make(name, 5), make(name, 5)
    assert [p.finish for p in one.parts] == [p.finish for p in two.parts]
    for a, b in zip(one.parts, two.parts, strict=True):
        assert np.array_equal(a.mesh.positions, b.mesh.positions)
        assert np.array_equal(a.mesh.uv, b.mesh.uv)


def test_styles_differ():
    sizes = {(m.width, m.height, m.attributes) for m in (make("seating.sofa", k) for k in range(6))}
    assert len(sizes) > 3
