"""Properties of the generated codecs of every message that the library ships."""

from __future__ import annotations

from typing import Any

import pytest
from codec_strategies import messages
from codec_support import library, shipped_sets
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from jausml.generators.common.message_examples import example_bytes
from jausml.runtime.message import DecodeError, EncodeError

FEW = settings(
    max_examples=25, deadline=None, database=None, suppress_health_check=list(HealthCheck)
)


def classes(set_name: str) -> list[tuple[Any, Any]]:
    views, _, module = library(set_name)
    return [(view, getattr(module, view.class_name)) for view in views]


def check_round_trip(strategy: st.SearchStrategy[Any]) -> None:
    @FEW
    @given(strategy)
    def round_trip(message: Any) -> None:
        data = message.encode()
        decoded = type(message).decode(data)
        # Scaled values moved to the nearest step: from there nothing moves any more.
        assert decoded.encode() == data
        assert type(message).decode(decoded.encode()) == decoded

    round_trip()


def check_refusals(cls: Any, example: bytes) -> None:
    @FEW
    @given(st.binary(max_size=40), st.integers(0, len(example)), st.binary(max_size=4))
    def decode(body: bytes, cut: int, other: bytes) -> None:
        for payload in (body, example[:2] + body, example[:cut] + other + example[cut + 4 :]):
            try:
                message = cls.decode(payload)
            except DecodeError:
                continue
            try:
                data = message.encode()
            except EncodeError:
                continue
            assert cls.decode(data).encode() == data

    decode()


@pytest.mark.parametrize("set_name", shipped_sets())
def test_what_is_encoded_decodes_to_the_nearest_values(set_name: str) -> None:
    for view, cls in classes(set_name):
        check_round_trip(messages(view, cls))


@pytest.mark.parametrize("set_name", shipped_sets())
def test_arbitrary_bytes_raise_nothing_but_decode_error(set_name: str) -> None:
    for view, cls in classes(set_name):
        check_refusals(cls, example_bytes(view))


@pytest.mark.parametrize("set_name", shipped_sets())
def test_examples_hold_the_codec_to_the_layout(set_name: str) -> None:
    for view, cls in classes(set_name):
        data = example_bytes(view)
        assert cls.decode(data).encode() == data
        with pytest.raises(DecodeError, match="bytes follow"):
            cls.decode(data + b"\0")
        for size in range(len(data)):
            with pytest.raises(DecodeError):
                cls.decode(data[:size])


@pytest.mark.parametrize("set_name", shipped_sets())
def test_defaults_are_legal_unless_something_must_be_given(set_name: str) -> None:
    for view, cls in classes(set_name):
        message = cls()
        assert message == cls()
        assert (view.code, view.jaus_name) == (message.CODE, message.NAME)
        problem = encode_problem(message)
        assert problem == "" or "length 0 is outside" in problem


def encode_problem(message: Any) -> str:
    try:
        message.encode()
    except EncodeError as error:
        return error.reason
    return ""
