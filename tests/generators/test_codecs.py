"""Properties of the generated codec of every message that the library ships.

Each definition of each service set has its own tests. A long run takes more examples of each:
JAUSML_EXAMPLES=1000 (see CONTRIBUTING.md).
"""

import contextlib
import os
import tracemalloc
from typing import Any

import pytest
from codec_nearness import differences
from codec_strategies import messages
from codec_support import (
    LIBRARY,
    codec,
    definitions,
    library,
    listed_definitions,
    load,
    read_messages,
    render,
    shipped_sets,
)
from for_each import for_each
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from sweeps import sweep

from jausml.runtime.wire.message import DecodeError, EncodeError, optional_fields
from jausml_generators.python.codec.examples import example_bytes

EXAMPLES = int(os.environ.get("JAUSML_EXAMPLES", "6"))
FEW = settings(
    max_examples=EXAMPLES,
    deadline=None,
    database=None,
    derandomize=EXAMPLES < 100,
    phases=[Phase.explicit, Phase.generate, Phase.shrink],
    suppress_health_check=list(HealthCheck),
)
DEFINITIONS = listed_definitions()
EVERY_DEFINITION = for_each(
    ("set_name", "definition"), DEFINITIONS, ids="-".join, shards=16, slow=True
)
# Python objects are larger than bytes on the wire, by about this factor.
BASE, FACTOR = 32_768, 1024


def test_no_definition_is_lost():
    built = [(name, key) for name in shipped_sets() for key in definitions(name)]
    assert sorted(built) == sorted(DEFINITIONS)
    assert len(built) > 400


@EVERY_DEFINITION
def test_what_is_encoded_decodes_to_the_nearest_values(set_name, definition):
    view, cls = codec(set_name, definition)

    @FEW
    @given(messages(view, cls))
    def round_trip(message: Any) -> None:
        data = message.encode()
        decoded = cls.decode(data)
        assert differences(view, message, decoded) == []
        # From the nearest step nothing moves any more.
        assert decoded.encode() == data
        assert cls.decode(decoded.encode()) == decoded

    round_trip()


@st.composite
def mutations(draw: st.DrawFn, payload: bytes) -> bytes:
    """Returns payloads that are the message no more, or only nearly."""
    body = payload[2:]
    cut = draw(st.integers(0, len(body)))
    kind = draw(st.sampled_from(["random", "short", "long", "flip", "replace", "ones"]))
    if kind == "random":
        body = draw(st.binary(max_size=40))
    elif kind == "short":
        body = body[:cut]
    elif kind == "long":
        body += draw(st.binary(min_size=1, max_size=8))
    elif kind == "flip" and body:
        bit = draw(st.integers(0, 8 * len(body) - 1))
        flipped = body[bit // 8] ^ 1 << bit % 8
        body = body[: bit // 8] + bytes([flipped]) + body[bit // 8 + 1 :]
    elif kind == "replace":
        body = body[:cut] + draw(st.binary(max_size=4)) + body[cut + draw(st.integers(0, 8)) :]
    elif kind == "ones":
        body = body[:cut] + b"\xff" * 8 + body[cut + 8 :]
    return payload[:2] + body


@EVERY_DEFINITION
def test_other_bytes_raise_nothing_but_decode_error(set_name, definition):
    view, cls = codec(set_name, definition)

    @FEW
    @given(messages(view, cls).flatmap(lambda message: mutations(message.encode())))
    def decode(payload: bytes) -> None:
        try:
            message = cls.decode(payload)
        except DecodeError:
            return
        try:
            data = message.encode()
        except EncodeError:  # values that peers send, though the definition does not list them
            return
        assert cls.decode(data).encode() == data

    decode()


@EVERY_DEFINITION
def test_huge_counts_take_no_memory(set_name, definition):
    view, cls = codec(set_name, definition)
    example = example_bytes(view)
    if not has_counts(view):
        return
    payloads = [
        example[:cut] + b"\xff" * width + example[cut + width :]
        for cut in range(2, len(example))
        for width in (1, 2, 4, 8)
    ]
    tracemalloc.start()
    try:
        for payload in payloads:
            tracemalloc.reset_peak()
            before = tracemalloc.get_traced_memory()[0]
            with contextlib.suppress(DecodeError):
                cls.decode(payload)
            taken = tracemalloc.get_traced_memory()[1] - before
            assert taken < BASE + FACTOR * len(payload)
    finally:
        tracemalloc.stop()


@EVERY_DEFINITION
def test_unknown_bits_of_the_presence_vector_are_refused(set_name, definition):
    view, cls = codec(set_name, definition)
    body, example = view.body, example_bytes(view)
    known = sum(member.is_optional for member in body.members)
    for bit in range(known, 8 * body.presence_size):
        flipped = int.from_bytes(example[2 : 2 + body.presence_size], "little") | 1 << bit
        payload = example[:2] + flipped.to_bytes(body.presence_size, "little")
        with pytest.raises(DecodeError, match="unknown bits in presence vector"):
            cls.decode(payload + example[2 + body.presence_size :])


def has_counts(view: Any) -> bool:
    members = list(view.body.members)
    for part in view.nested:
        members += getattr(part, "members", ())
    return any(member.value.kind in ("list", "blob") for member in members)


@pytest.mark.parametrize("set_name", sweep(shipped_sets(), every=4))
def test_examples_hold_the_codec_to_the_layout(set_name):
    for view, cls in classes(set_name):
        data = example_bytes(view)
        assert cls.decode(data).encode() == data
        with pytest.raises(DecodeError, match="bytes follow"):
            cls.decode(data + b"\0")
        for size in range(len(data)):
            with pytest.raises(DecodeError):
                cls.decode(data[:size])


@pytest.mark.parametrize("set_name", shipped_sets())
def test_defaults_are_legal_unless_something_must_be_given(set_name):
    for view, cls in classes(set_name):
        message = cls()
        assert message == cls()
        assert (view.code, view.jaus_name) == (message.CODE, message.NAME)
        problem = encode_problem(message)
        assert problem == "" or "length 0 is outside" in problem


def classes(set_name: str) -> list[tuple[Any, Any]]:
    views, _, module = library(set_name)
    return [(view, getattr(module, view.class_name)) for view in views]


def encode_problem(message: Any) -> str:
    try:
        message.encode()
    except EncodeError as error:
        return error.reason
    return ""


@for_each("set_name", shipped_sets())
def test_optional_fields_and_they_alone_default_to_none(set_name):
    """What a query asks for is chosen by it."""
    views, _, module = library(set_name)
    for view in views:
        optional = tuple(member.attribute for member in view.body.members if member.is_optional)
        assert optional_fields(getattr(module, view.class_name)) == optional


def test_octets_that_a_definition_does_not_list_are_never_sent():
    views = [view for view in read_messages(LIBRARY / "hmi.xmi") if view.code == 0x4701]
    message_class = load(render(tuple(views)), "data_definitions").ReportDataDefinition
    many = bytes([10, 0, *range(9), 202])
    message = message_class.decode(b"\x01\x47" + bytes(2) + many)
    refused = "primitive_data_definition: 202 is outside 0 .. 19"
    for _ in range(2):  # also once somebody has looked at the records
        with pytest.raises(EncodeError, match=refused):
            message.encode()
        assert message.primitive_data_definition_list[9].primitive_data_definition == 202
