"""Whatever is in a file or an answer, it is read or refused with one of our errors."""

import contextlib
import gzip
import json
import math
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.strategies import SearchStrategy
from pydantic import BaseModel

from hostile import hostile_records as records
from hostile import hostile_scenes as scenes
from hostile.damage import bounded, damaged, hostile
from hostile.hostile_values import VALUES
from hypernav.app.build.presets import preset
from hypernav.core.chat import Question
from hypernav.core.errors import ConfigError, EpisodeError, RecordingError, SceneError
from hypernav.io.layered_config import layered
from hypernav.lab.datasets.habitat_files import episodes_of, read_episodes
from hypernav.search.models.chat.answer_parsing import parse_answer
from hypernav.search.models.chat.recording import ReplayChat
from hypernav.search.models.chat.vlm_families import FAMILIES
from hypernav.search.perception.local.grounding_format import read_grounding
from hypernav.simulator.worlds.scenes.loading import read_scene

pytestmark = pytest.mark.slow

ANYTHING = st.sampled_from(VALUES) | st.integers() | st.floats() | st.text(max_size=5)


@st.composite
def changed(draw: st.DrawFn, document: Any) -> Any:
    """A document with other values at one to three places."""
    for _ in range(draw(st.integers(1, 3))):
        place = draw(st.sampled_from(list(scenes.places(document))))
        document = scenes.replaced(document, place, draw(ANYTHING))
        if not isinstance(document, dict | list) or not document:
            break
    return document


def text_of(document: SearchStrategy[Any]) -> SearchStrategy[bytes]:
    return document.map(lambda value: json.dumps(value).encode())


SOUND = scenes.sound()
BINARY = bytes(SOUND.binary)
DOCUMENT = scenes.document_of(SOUND)
WHOLE = scenes.as_glb(json.dumps(DOCUMENT).encode(), BINARY)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("fuzz")


@hostile
@given(
    text_of(changed(DOCUMENT)).map(lambda text: scenes.as_glb(text, BINARY))
    | damaged(BINARY).map(lambda binary: scenes.as_glb(json.dumps(DOCUMENT).encode(), binary))
    | damaged(WHOLE)
)
def test_scenes(folder, content):
    path = folder / "scene.glb"
    path.write_bytes(content)
    (folder / "objects.json").unlink(missing_ok=True)
    try:
        with bounded():
            scene = read_scene(path)
    except SceneError:
        return
    assert len(scene.faces) > 0
    assert 0 <= scene.faces.min() <= scene.faces.max() < len(scene.vertices)
    assert all(map(math.isfinite, scene.vertices[scene.faces].ravel()))


@hostile
@given(text_of(changed(records.OBJECTS)) | damaged(json.dumps(records.OBJECTS).encode()))
def test_descriptions_of_objects(folder, content):
    path = SOUND.write(folder / "scene.glb")
    (folder / "objects.json").write_bytes(content)
    with contextlib.suppress(SceneError), bounded():
        read_scene(path)


YAML = st.text(alphabet="ab:{}[]-,&*!|>'\"%#?~ \n\t0.1_enxf", max_size=40)
PRESET = preset("default").model_dump(mode="json")
SECTIONS = st.sampled_from([*PRESET, "x"])
SOME = {name: PRESET[name] for name in ("embodiment", "mapping", "own")}


@hostile
@given(
    YAML
    | st.tuples(SECTIONS, YAML).map(lambda pair: f"{pair[0]}: {pair[1]}")
    | changed(SOME).map(json.dumps)
)
def test_configurations(folder, text):
    path = folder / "a.yaml"
    path.write_text(text)
    with contextlib.suppress(ConfigError):
        layered(preset("default"), file=path, environment={})


@hostile
@given(
    changed(records.EXCHANGE).map(records.recording) | damaged(records.recording(records.EXCHANGE))
)
def test_recordings(folder, content):
    path = folder / "a.jsonl"
    path.write_bytes(content)
    with contextlib.suppress(RecordingError):
        ReplayChat(path).identify()


EPISODES = json.dumps(records.EPISODES).encode()


@hostile
@given(text_of(changed(records.EPISODES)) | damaged(EPISODES) | damaged(gzip.compress(EPISODES)))
def test_episode_files(folder, content):
    path = folder / "a.json.gz"
    path.write_bytes(content)
    try:
        with bounded():
            episodes = episodes_of(read_episodes(path))
    except EpisodeError:
        return
    assert all(math.isfinite(number) for episode in episodes for number in episode.start.xy)


class Choice(BaseModel):
    number: int
    why: str = ""


ANSWERS = (
    st.text(max_size=60)
    | st.sampled_from(
        ["<think>" * 3000, "[" * 5000, '{"a":' * 3000, "```json\n[1", "1e999", "9" * 5000, "\ud800"]
    )
    | st.recursive(
        ANYTHING,
        lambda inner: (
            st.lists(inner, max_size=4)
            | st.dictionaries(st.sampled_from(["bbox_2d", "label", "score", "x1", "number"]), inner)
        ),
        max_leaves=12,
    ).map(json.dumps)
)
QUESTIONS = (
    Question("ground", "where?"),
    Question("choose block", "which?", allowed=("1", "2", "none")),
    Question("verify", "there?", form=Choice),
)


@hostile
@given(ANSWERS, st.sampled_from(sorted(FAMILIES)))
def test_answers_of_models(text, family):
    for question in QUESTIONS:
        answer = parse_answer(question, text, model="m")
        assert (answer.value is None) == (answer.fault is not None)
    for one in read_grounding(text, FAMILIES[family], 640, 480).boxes:
        assert 0.0 <= one.box.x_min < one.box.x_max <= 640.0
        assert 0.0 <= one.box.y_min < one.box.y_max <= 480.0
        assert 0.0 <= one.score <= 1.0
