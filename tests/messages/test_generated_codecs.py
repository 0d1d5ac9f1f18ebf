"""The interpreting codec and the generated codecs say the same of any bytes, for every message.

A long run takes more examples of each: JAUSML_EXAMPLES=1000 (see CONTRIBUTING.md).
"""

import functools
import os

import pytest
from codec_strategies import messages
from codec_support import LIBRARY, LIBRARY_FILES, FieldNames, library, shipped_sets
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from sweeps import sweep

from jausml.language.model import read_models
from jausml.live.messages import CodecError
from jausml.live.messages.catalogue import as_it_is
from jausml.live.messages.defined import DefinedCatalogue
from jausml.live.messages.values import as_numbers
from jausml.runtime.wire.message import DecodeError, EncodeError

EXAMPLES = int(os.environ.get("JAUSML_EXAMPLES", "3"))
FEW = settings(
    max_examples=EXAMPLES,
    deadline=None,
    database=None,
    derandomize=EXAMPLES < 100,
    phases=[Phase.explicit, Phase.generate],
    suppress_health_check=list(HealthCheck),
)


@functools.cache
def catalogue_of(set_name):
    return DefinedCatalogue(read_models([LIBRARY / LIBRARY_FILES[set_name]]).model)


def attempt(action, *refusals):
    """Returns what an action returns, None when it refuses."""
    try:
        return action()
    except refusals:
        return None


@st.composite
def wire(draw, strategy):
    """Draws the bytes of a message, or bytes that are nearly those."""
    payload = draw(strategy).encode()
    kind = draw(st.sampled_from(["whole", "cut", "flip", "more", "random"]))
    at = draw(st.integers(2, len(payload)))
    if kind == "cut":
        return payload[:at]
    if kind == "flip" and at < len(payload):
        return payload[:at] + bytes([payload[at] ^ draw(st.integers(1, 255))]) + payload[at + 1 :]
    if kind == "more":
        return payload + draw(st.binary(max_size=4))
    return payload[:2] + draw(st.binary(max_size=24)) if kind == "random" else payload


def check(view, module, entry):
    names = FieldNames(view, module)

    @FEW
    @given(wire(messages(view, names.cls)))
    def agree(payload):
        generated = attempt(lambda: names.cls.decode(payload), DecodeError)
        fields = attempt(lambda: entry.decode(payload, as_it_is), CodecError)
        assert (generated is None) == (fields is None)
        if generated is not None:
            # As text: no number equals itself when it is none, but it reads the same.
            assert repr(names.to_fields(generated)) == repr(as_numbers(fields))
            theirs = attempt(generated.encode, EncodeError)
            assert attempt(lambda: entry.encode(fields), CodecError) == theirs

    agree()


@pytest.mark.parametrize("set_name", sweep(shipped_sets(), every=8))
def test_both_codecs_agree(set_name):
    views, _, module = library(set_name)
    for view in views:
        found = [e for e in catalogue_of(set_name).find(view.code) if e.name == view.jaus_name]
        assert found, view.jaus_name
        for entry in found:
            check(view, module, entry)
