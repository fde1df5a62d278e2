"""Messages: the page says what the models say, its examples work, damage is refused."""

import json
import re

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from palms.errors import FormatError, InputError
from palms.server import messages
from palms.server.messages import answers, frames, inputs, rest, speech
from palms.server.messages.base import Message
from tests.docs.pages import DOCS, blocks
from tests.server.conftest import Phone

PAGE = DOCS / "reference" / "messages.md"
MODELS = {
    name: model
    for module in (inputs, answers, rest, speech)
    for name, model in vars(module).items()
    if isinstance(model, type)
    and issubclass(model, Message)
    and model.__module__ == module.__name__
}


def heading(model):
    return model.model_fields["type"].default if "type" in model.model_fields else model.__name__


def sections():
    parts = re.split(r"^### ", PAGE.read_text(), flags=re.MULTILINE)[1:]
    return {part.partition("\n")[0]: part for part in parts}


def default(field):
    if field.is_required():
        return "required"
    value = list(field.default) if isinstance(field.default, tuple) else field.default
    return f"`{json.dumps(value)}`"


def test_each_message_has_its_section_and_each_field_its_row():
    found = sections()
    assert set(found) == {heading(model) for model in MODELS.values()}
    for model in MODELS.values():
        rows = re.findall(r"^\| `(\w+)` \| (.+?) \| (.+?) \|$", found[heading(model)], re.MULTILINE)
        assert [(name, value) for name, value, _ in rows] == [
            (name, default(field)) for name, field in model.model_fields.items()
        ]
        assert all(len(meaning) > 5 for _, _, meaning in rows)


def test_words_that_a_field_may_hold_are_on_the_page():
    text = PAGE.read_text()
    for kind in (*messages.EventKind.__args__, *messages.SayKind.__args__):
        assert f"`{kind}`" in text
    for field in (answers.Error.model_fields["code"], answers.Ended.model_fields["reason"]):
        assert all(f"`{word}`" in text for word in field.annotation.__args__)


def test_the_version_is_on_the_page_and_frames_have_their_sizes():
    text = PAGE.read_text()
    assert f"`{messages.SCHEMA}`" in text
    assert f"| {frames._PARTICLES.size} | N times 2 int16" in text
    assert f"| {frames._HEATMAP.size} | rest |" in text


def examples():
    return [json.loads(block.text) for block in blocks(PAGE) if block.kind == "json"]


def test_examples_of_single_messages_are_of_their_model():
    known = {heading(model): model for model in MODELS.values()}
    for name, section in sections().items():
        for text in re.findall(r"```json\n(.*?)\n```", section, re.DOTALL):
            model = known[name]
            message = model.model_validate_json(text)
            assert set(json.loads(text)) <= set(model.model_fields)
            assert model.model_validate_json(message.model_dump_json()) == message


@pytest.mark.parametrize("number", range(2))
def test_conversations_of_the_page_work(serve, tmp_path, number):
    conversation = [each for each in examples() if isinstance(each, list)][number]
    folder = tmp_path / "sample"
    folder.mkdir()
    phone = Phone(serve(folder=folder))
    phone.say(conversation[0])
    assert phone.next()["type"] == "welcome"
    for message in conversation[1:]:
        assert set(message) <= set(vars(messages)[message["type"].title()].model_fields)
        phone.say(message)
    answers_, code = phone.rest()
    assert not [each for each in answers_ if each["type"] == "error"]
    numbers = [each["seq"] for each in answers_ if each["type"] == "ack"]
    assert numbers == list(range(1, len(conversation) - 1))
    last = [each for each in answers_ if each["type"] == "estimate"][-1]
    assert last["walked_m"] == pytest.approx(1.1, abs=0.15)
    assert last["facing_rad"] is not None
    assert (answers_[-1]["type"], code) == ("ended", 1000)


@pytest.mark.parametrize(
    "text",
    [
        "", "[]", "null", "{}", '{"type": "scan"}', '{"type": "hello", "role": "king"}', "\x00",
        '{"type": "pause", "seq": 0}', '{"type": "pause", "seq": 1.5}',
        '{"type": "pause", "seq": "1"}',
        '{"type": "odometry", "seq": 1, "samples": []}',
        '{"type": "odometry", "seq": 1, "samples": [{"t_s": 1}]}',
        '{"type": "odometry", "seq": 1, "samples": [{"t_s": NaN, "position_m": [0, 0]}]}',
        '{"type": "odometry", "seq": 1, "samples": [{"t_s": 1, "position_m": [1e999, 0]}]}',
        '{"type": "odometry", "seq": 1, "samples": '
        '[{"t_s": 1, "position_m": [0, 0], "displacement_m": [0, 0]}]}',
        '{"type": "hint", "seq": 1, "room": "a", "place_m": [0, 0]}',
        '{"type": "hint", "seq": 1, "room": "a", "probability": 1}',
        '{"type": "tell", "seq": 1, "text": ""}', '{"type": "tell", "text": "room 215"}',
        '{"type": "ask", "what": "why"}', '{"type": "preferences", "every_s": 1}',
        '{"type": "preferences", "language": "../en"}', '{"type": "preferences", "step_m": 0}',
        '{"type": "inertial", "seq": 1, "readings": '
        '[{"sensor": "gyroscope", "t_s": 0, "values": [1]}]}',
        '{"type": "scan", "seq": 1, "t_s": 0, "planes": [], "pose": {}}', "[" * 100_000,
    ],
)  # fmt: skip
def test_what_is_no_message_is_refused_in_one_line(text):
    with pytest.raises(InputError) as refused:
        messages.parse_message(text)
    assert "\n" not in str(refused.value)
    assert len(str(refused.value)) < 400


@given(st.text(max_size=50))
def test_what_is_no_message_raises_nothing_else(text):
    with pytest.raises(InputError):
        messages.parse_message(text)


def test_keys_that_are_not_known_are_ignored():
    assert messages.parse_message('{"type": "pause", "seq": 1, "mood": "calm"}').seq == 1


PLACES = arrays(
    np.float64, st.tuples(st.integers(1, 40), st.just(2)), elements=st.floats(-4000, 4000)
)


@given(PLACES, st.integers(0, 2**40), st.floats(0, 2e9))
def test_particles_survive_the_wire(places, seq, t_s):
    label = (np.arange(len(places)) % 256).astype(np.uint8)
    frame = messages.ParticlesFrame(seq, t_s, places, label)
    content = messages.pack_particles(frame)
    again = messages.unpack_frame(content)
    assert (again.seq, again.t_s) == (seq, t_s)
    assert (again.label == label).all()
    span = float((places.max(axis=0) - places.min(axis=0)).max())
    assert np.abs(again.position_m - places).max() <= max(0.0051, 0.51 * span / 65_000)
    for cut in (0, 2, 10, len(content) - 1):
        with pytest.raises(FormatError):
            messages.unpack_frame(content[:cut])


def test_two_thousand_particles_are_ten_kilobytes():
    frame = messages.ParticlesFrame(1, 0.0, np.zeros((2000, 2)), np.zeros(2000, np.uint8))
    assert len(messages.pack_particles(frame)) == 10_044


def test_heatmaps_survive_the_wire():
    frame = messages.HeatmapFrame(
        7, 2, 4, 0.5, (1.5, -2.5), 0.25, (-3.0, 8.0), b"\x89PNG...", 3, 16
    )
    assert messages.unpack_frame(messages.pack_heatmap(frame)) == frame
    with pytest.raises(FormatError):
        messages.unpack_frame(b"HF\x02" + b"\x00" * 80)


def test_what_is_told_is_an_input_and_what_is_asked_is_none():
    told = messages.parse_input('{"type": "tell", "seq": 3, "text": "two fifteen"}')
    assert (told.seq, told.text) == (3, "two fifteen")
    for text in ('{"type": "ask"}', '{"type": "preferences"}'):
        assert messages.parse_message(text).type in ("ask", "preferences")
        with pytest.raises(InputError):
            messages.parse_input(text)
