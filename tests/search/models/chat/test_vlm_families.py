import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from chat_models import image
from hypernav.core.errors import ConfigError, ModelError
from hypernav.core.geometry.boxes import Box
from hypernav.search.models.chat.vlm_families import (
    FAMILIES,
    MODEL_LINES,
    family_named,
    family_of,
    smart_resize,
)

sides = st.integers(1, 4000)
families = st.sampled_from(sorted(FAMILIES.values(), key=lambda family: family.name))


def test_the_camera_image_becomes_644_by_476():
    family = family_named("qwen2.5-vl")
    assert family.sent_size(640, 480) == (644, 476)
    assert family.prepared(image(0, 480, 640)).shape == (476, 644, 3)


def test_relative_families_are_sent_the_image_as_it_is():
    view = image()
    assert family_named("qwen3-vl").prepared(view) is view


@given(st.integers(20, 3000), st.integers(20, 3000))
def test_resized_sides_are_multiples_and_the_area_is_within_bounds(width: int, height: int):
    bounds = {"min_pixels": 3136, "max_pixels": 1_000_000}
    new = smart_resize(width, height, **bounds)
    assert new[0] % 28 == new[1] % 28 == 0
    assert 3136 <= new[0] * new[1] <= 1_000_000


@given(st.integers(20, 2000), st.integers(20, 2000))
def test_resizing_twice_is_resizing_once(width: int, height: int):
    """So a server that resizes what we have resized changes nothing."""
    bounds = {"min_pixels": 3136, "max_pixels": 12_845_056}
    new = smart_resize(width, height, **bounds)
    assert smart_resize(*new, **bounds) == new


def test_a_sliver_is_refused():
    with pytest.raises(ModelError, match="too narrow"):
        smart_resize(1000, 3, min_pixels=1, max_pixels=10**9)


@given(families, st.integers(28, 2000), st.integers(28, 2000), st.data())
def test_boxes_there_and_back(family, width: int, height: int, data: st.DataObject):
    x = sorted(data.draw(st.tuples(st.floats(0, width), st.floats(0, width))))
    y = sorted(data.draw(st.tuples(st.floats(0, height), st.floats(0, height))))
    box = Box(float(x[0]), float(y[0]), float(x[1]), float(y[1]))
    there = family.from_image(box, width, height)
    extent = family.extent(width, height)
    assert 0.0 <= there.x_min <= there.x_max <= extent[0] * (1 + 1e-9)
    assert 0.0 <= there.y_min <= there.y_max <= extent[1] * (1 + 1e-9)
    back = family.to_image(there, width, height)
    corners = [[b.x_min, b.y_min, b.x_max, b.y_max] for b in (box, back)]
    np.testing.assert_allclose(corners[0], corners[1], atol=1e-6)


@pytest.mark.parametrize(
    ("model", "family"),
    [
        ("Qwen/Qwen2.5-VL-7B-Instruct", "qwen2.5-vl"),
        ("qwen2.5vl:7b", "qwen2.5-vl"),
        ("Qwen2_5-VL-3B-AWQ", "qwen2.5-vl"),
        ("/models/Qwen2-VL-7B", "qwen2-vl"),
        ("qwen3-vl-235b-a22b", "qwen3-vl"),
        ("Qwen/Qwen3.5-27B", "qwen3-vl"),
        ("zai-org/GLM-4.5V", "glm-v"),
        ("glm-4.1v-9b-thinking", "glm-v"),
        ("zai-org/GLM-5V-Turbo", "glm-v"),
        ("gemini-3-flash", "gemini"),
        ("google/gemma-4-31B-it", "gemini"),
        ("gemma4:27b", "gemini"),
        ("OpenGVLab/InternVL3_5-8B", "thousandths"),
        ("internvl2.5-26b", "thousandths"),
        ("BAAI/RoboBrain2.0-7B", "qwen2.5-vl"),
        ("BAAI/RoboBrain2.5-8B-NV", "thousandths"),
        ("nvidia/cosmos-reason2-8b", "thousandths"),
        ("openbmb/MiniCPM-V-4_5", "thousandths"),
        ("openbmb/MiniCPM-Llama3-V-2_5", "thousandths"),
        ("openbmb/minicpm-o-2_6", "thousandths"),
        ("LiquidAI/LFM2.5-VL-1.6B", "unit"),
        ("allenai/Molmo-7B-D-0924", "molmo"),
        ("allenai/Molmo2-8B", "molmo2"),
        ("google/paligemma2-3b-mix-448", "paligemma"),
        ("microsoft/Florence-2-large", "florence-2"),
        ("IffYuan/Embodied-R1-3B-v1", "embodied-r1"),
        ("deepseek-ai/deepseek-vl2-small", "deepseek-vl2"),
        ("doubao-seed-1-6-vision-250815", "thousandths"),
        ("ByteDance-Seed/Seed1.5-VL", "thousandths"),
        ("XiaomiMiMo/MiMo-VL-7B-RL", "qwen2.5-vl"),
        ("moondream/moondream3-preview", "unit"),
        ("claude-opus-4-5", "claude"),
        ("01-ai/Yi-VL-6B", "thousandths"),
        ("Qwen/Qwen-VL-Chat", "thousandths"),
        ("Qwen/Qwen2.5-Omni-7B", "qwen2.5-vl"),
    ],
)
def test_reads_the_family_off_the_name(model: str, family: str):
    assert family_of(model).name == family


@pytest.mark.parametrize(
    "model",
    [
        *("gpt-6-luna", "my-finetune", "glm-4.6", "qwen2.5-7b-instruct", "glm-4v-9b"),
        *("moonshotai/Kimi-VL-A3B-Thinking", "google/gemma-3-27b-it", "nvidia/Cosmos-Reason1-7B"),
        *("meta-llama/Llama-3.2-11B-Vision", "mistralai/Pixtral-12B-2409", "CohereLabs/aya-vision"),
        *("microsoft/Phi-4-multimodal-instruct", "HuggingFaceTB/SmolVLM-Instruct", "MolmoAct-7B"),
        *("IffYuan/Embodied-R1.5", "openbmb/MiniCPM-OCR", "allenai/MolmoPoint-8B"),
        # Names that hold another line's: what a model was made of, or its size.
        *("google/medgemma-4b-it", "translategemma-4b-it", "llava-qwen3-8b", "qwen-3b-vl"),
        *("Kwai-Keye/Keye-VL-1.5-Qwen3-8B", "gemma-3-12b-claude-distill"),
    ],
)
def test_never_guesses_a_family(model: str):
    with pytest.raises(ConfigError, match=r"name its family: qwen2\.5-vl"):
        family_of(model)


def test_every_line_of_models_has_a_source_and_a_family():
    assert len(MODEL_LINES) >= 25
    assert len({line.name for line in MODEL_LINES}) == len(MODEL_LINES)
    assert all(line.source and line.family in FAMILIES for line in MODEL_LINES)


def test_unknown_family_lists_the_known_ones():
    with pytest.raises(ConfigError, match="thousandths"):
        family_named("qwen9")
