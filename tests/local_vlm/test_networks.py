"""SAM, open-vocabulary detectors and similarity, with random weights of the real shape."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from chat_models import image
from hypernav.app.build.agents import build_agent
from hypernav.app.build.components.component_specs import ComponentSpecs
from hypernav.core.errors import ModelError
from hypernav.core.geometry.boxes import Box
from hypernav.core.geometry.camera import PinholeCamera
from hypernav.core.geometry.transforms import Pose2, Transform
from hypernav.core.goal import Goal
from hypernav.core.observation import Observation
from hypernav.search.agents.search import SearchAgent
from hypernav.search.models import sam, zero_shot
from hypernav.search.models.config import SamConfig, SimilarityConfig, ZeroShotConfig
from hypernav.search.models.sam import SamSegmenter
from hypernav.search.models.similarity import ImageTextSimilarity
from hypernav.search.models.zero_shot import ZeroShotDetector
from images import key_image
from small_worlds import small_config

Tiny = Callable[[str], Path]
BOX = Box(10.0, 12.0, 50.0, 40.0)


def observe(height: int, width: int) -> Observation:
    camera = PinholeCamera.from_hfov(width, height, 79.0)
    depth = np.ones((height, width), np.float32)
    pose = Pose2(0.0, 0.0, 0.0)
    return Observation(image(0, height, width), depth, camera, Transform.identity(), pose)


@pytest.mark.parametrize("name", ["sam", "sam2"])
@pytest.mark.parametrize("size", [(48, 64), (96, 72)])
def test_masks_have_the_images_size_and_stay_in_the_box(
    tiny: Tiny,
    device: str,
    name: str,
    size: tuple[int, int],
    monkeypatch: pytest.MonkeyPatch,
):
    view = observe(*size)
    segmenter = SamSegmenter(str(tiny(name)), SamConfig(device=device))
    clipped = segmenter.segment(view, BOX)
    monkeypatch.setattr(sam, "clipped_to_box", lambda mask, box: mask)
    free = segmenter.segment(view, BOX)
    assert free.shape == clipped.shape == size
    assert free.dtype == clipped.dtype == np.bool_
    inside = np.zeros(size, bool)
    inside[12:40, 10:50] = True
    np.testing.assert_array_equal(clipped, free & inside)
    assert free.any()


@pytest.mark.parametrize("name", ["sam", "sam2"])
def test_another_box_gives_another_mask(
    tiny: Tiny, device: str, name: str, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(sam, "clipped_to_box", lambda mask, box: mask)
    segmenter = SamSegmenter(str(tiny(name)), SamConfig(device=device))
    view = observe(48, 64)
    first = segmenter.segment(view, Box(0.0, 0.0, 8.0, 8.0))
    second = segmenter.segment(view, Box(40.0, 20.0, 64.0, 48.0))
    assert (first != second).any()


@pytest.mark.parametrize("name", ["sam", "sam2"])
def test_another_point_gives_another_mask(tiny: Tiny, device: str, name: str):
    segmenter = SamSegmenter(str(tiny(name)), SamConfig(device=device))
    view = observe(48, 64)
    first, second = (segmenter.segment_point(view, *at) for at in ((4.0, 4.0), (60.0, 40.0)))
    assert first.shape == second.shape == (48, 64)
    assert (first != second).any()


def test_a_box_outside_the_image_holds_nothing(tiny: Tiny):
    segmenter = SamSegmenter(str(tiny("sam")))
    assert not segmenter.segment(observe(48, 64), Box(70.0, 0.0, 90.0, 20.0)).any()


@pytest.mark.parametrize("name", ["owlv2", "grounding_dino"])
def test_open_vocabulary_boxes_lie_in_the_image_best_first(
    tiny: Tiny, device: str, name: str, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(zero_shot, "_MIN_SIDE_PX", 0.0)
    config = ZeroShotConfig(device=device, score_threshold=0.0)
    detector = ZeroShotDetector(str(tiny(name)), config)
    found = detector.detect(observe(48, 64), Goal("red sofa"))
    assert found
    assert [one.label for one in found] == ["red sofa"] * len(found)
    scores = [one.score for one in found]
    assert scores == sorted(scores, reverse=True)
    for one in found:
        assert one.box == one.box.clipped(64, 48)
        assert 0.0 <= one.score <= 1.0


@pytest.mark.parametrize("name", ["owlv2", "grounding_dino"])
def test_nothing_is_surer_than_certain(tiny: Tiny, device: str, name: str):
    detector = ZeroShotDetector(str(tiny(name)), ZeroShotConfig(device=device, score_threshold=1.0))
    assert detector.detect(observe(48, 64), Goal("bed")) == []


@pytest.mark.parametrize("name", ["sam", "sam2"])
def test_the_corners_of_a_box_reach_the_network_exactly(tiny: Tiny, device: str, name: str):
    """They are scaled to its image of 64×64, where bfloat16 has steps of a quarter pixel."""
    segmenter = SamSegmenter(str(tiny(name)), SamConfig(device=device, dtype="bfloat16"))
    given: list[Any] = []
    segmenter._model.register_forward_pre_hook(
        lambda _, args, inputs: given.append(inputs["input_boxes"]), with_kwargs=True
    )
    segmenter.segment(observe(640, 640), Box(313.0, 111.0, 627.0, 401.0))
    assert given[0].flatten().tolist() == pytest.approx([31.3, 11.1, 62.7, 40.1], abs=1e-4)


@pytest.mark.parametrize("name", ["owlv2", "grounding_dino"])
def test_boxes_are_scaled_to_pixels_exactly(
    tiny: Tiny, device: str, name: str, monkeypatch: pytest.MonkeyPatch
):
    """Edges computed in bfloat16 would be up to 1.25 pixels off."""
    monkeypatch.setattr(zero_shot, "_MIN_SIDE_PX", 0.0)
    config = ZeroShotConfig(device=device, dtype="bfloat16", score_threshold=0.0)
    detector = ZeroShotDetector(str(tiny(name)), config)
    said: list[Any] = []
    detector._model.register_forward_hook(lambda _, args, outputs: said.append(outputs.pred_boxes))
    found = detector.detect(observe(480, 640), Goal("bed"))
    x, _, width, _ = said[0][0].double().cpu().numpy().T
    expected = 640.0 * (x + width / 2).clip(0.0, 1.0)
    edges = np.array([one.box.x_max for one in found])
    assert np.abs(edges[:, None] - expected).min(axis=1).max() < 1e-3


@pytest.mark.parametrize("name", ["clip", "siglip", "blip2"])
def test_similarity_is_a_number_that_depends_on_both_sides(tiny: Tiny, device: str, name: str):
    model = ImageTextSimilarity(str(tiny(name)), SimilarityConfig(device=device))
    one, other = image(0), image(1)
    values = {
        model.similarity(one, "a bed"),
        model.similarity(one, "a long red sofa"),
        model.similarity(other, "a bed"),
    }
    assert len(values) == 3
    assert all(0.0 <= value <= 1.0 for value in values)
    assert model.similarity(one, "a bed") == model.similarity(one, "a bed")


def test_the_contrasting_head_of_blip2_says_the_cosine_of_the_query_that_fits_best(
    tiny: Tiny, device: str
):
    """As VLFM takes it; the matching head of the same model says something else."""
    path = str(tiny("blip2"))
    model = ImageTextSimilarity(path, SimilarityConfig(device=device, dtype="float32", head="itc"))
    said: list[Any] = []
    model._model.register_forward_hook(lambda _, args, outputs: said.append(outputs))
    values = [
        model.similarity(image(number), text)
        for number in (0, 1)
        for text in ("a bed", "a long red sofa")
    ]
    cosines = []
    for outputs in said:
        queries = outputs.image_embeds[0].double().cpu().numpy()
        words = outputs.text_embeds[0].double().cpu().numpy()
        assert np.linalg.norm(queries, axis=1) == pytest.approx(np.ones(4), abs=1e-5)
        assert np.linalg.norm(words) == pytest.approx(1.0, abs=1e-5)
        cosines.append(float((queries @ words).max()))
    assert len(set(cosines)) == 4
    assert values == pytest.approx(np.clip(cosines, 0.0, 1.0), abs=1e-5)
    matching = ImageTextSimilarity(path, SimilarityConfig(device=device, dtype="float32"))
    assert matching.similarity(image(0), "a bed") != values[0]


@pytest.mark.parametrize("name", ["clip", "siglip", "blip2"])
def test_vectors_of_one_side_do_not_depend_on_the_other_and_say_the_similarity(
    tiny: Tiny, device: str, name: str
):
    config = SimilarityConfig(device=device, dtype="float32", head="itc")
    model = ImageTextSimilarity(str(tiny(name)), config)
    texts = ["a bed", "a long red sofa", "a"]
    of_texts = model.text_vectors(texts)
    of_images = [model.image_vectors(image(number)) for number in (0, 1)]
    for vectors in (of_texts, *of_images):
        assert vectors.dtype == np.float32
        assert np.linalg.norm(vectors, axis=1) == pytest.approx(np.ones(len(vectors)), abs=1e-5)
    assert len(of_images[0]) == (4 if name == "blip2" else 1)
    for text, vector in zip(texts, of_texts, strict=True):
        assert model.text_vectors([text])[0] == pytest.approx(vector, abs=1e-5)
    cosines = np.array([[(one @ text).max() for text in of_texts] for one in of_images])
    said = np.array([[model.similarity(image(k), text) for text in texts] for k in (0, 1)])
    if name == "clip":
        assert said == pytest.approx((cosines + 1.0) / 2.0, abs=1e-5)
    elif name == "blip2":
        assert said == pytest.approx(cosines.clip(0.0, 1.0), abs=1e-5)
    else:  # the sigmoid of a rising line
        assert (said.ravel().argsort() == cosines.ravel().argsort()).all()


def test_a_head_that_compares_pairs_has_no_vectors(tiny: Tiny, device: str):
    model = ImageTextSimilarity(str(tiny("blip2")), SimilarityConfig(device=device, head="itm"))
    for ask in (lambda: model.image_vectors(image(0)), lambda: model.text_vectors(["a bed"])):
        with pytest.raises(ModelError, match=r'"itm" compares pairs .* use the head "itc"'):
            ask()


def test_remembered_images_are_ranked_by_a_model_that_is_named(tiny: Tiny, device: str):
    path = str(tiny("clip"))
    use = {"similarity": {"device": device}}
    config = small_config(similarity_scorer=use, image_recall={"least_similarity": 1.5})
    parts = build_agent(config, ComponentSpecs(similarity=f"local:{path}"))
    assert parts.looks_at_colours
    assert parts.chosen.as_dict()["similarity"] == f"local:{path}"
    assert isinstance(parts.agent, SearchAgent)
    ranking = parts.agent.components.image_ranking
    assert ranking is not None
    assert (ranking.least, ranking.name) == (1.5, f"similarity by {Path(path).name}")
    images = [key_image(number, image(number)) for number in range(9)]
    ranked = ranking.ranked(images, Goal("bed"))
    assert sorted(one.number for one in ranked) == list(range(9))
    assert ranked == ranking.ranked(images, Goal("bed"))
    assert ranked != ranking.ranked(images, Goal("long red sofa"))


@pytest.mark.parametrize("load", [SamSegmenter, ZeroShotDetector, ImageTextSimilarity])
def test_a_model_of_another_kind_is_refused(tiny: Tiny, load: Callable[[str], object]):
    with pytest.raises(ModelError):
        load(str(tiny("qwen25_vl")))


@pytest.mark.parametrize("load", [SamSegmenter, ZeroShotDetector, ImageTextSimilarity])
def test_missing_weights_say_how_to_get_them(load: Callable[[str], object]):
    with pytest.raises(ModelError, match="hf download somebody/something"):
        load("somebody/something")
