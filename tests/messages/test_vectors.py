"""The vectors of tests/vectors by the interpreting codec and by the generated classes.

The dissector reads them in tests/live/test_wireshark.py and, without Wireshark, in
tests/generators/test_dissected_vectors.py.
"""

import functools
import re

import pytest
from codec_support import LIBRARY_FILES, ROOT, FieldNames, library, load, read_messages, render
from for_each import for_each
from wire_vectors import close, given, payload_of, vectors

from jausml.live import messages
from jausml.live.messages import load_catalogue
from jausml.live.messages.catalogue import as_it_is
from jausml.runtime import wire

# What the interpreter and the generated classes say of each kind of error.
DECODING = {
    "ends too early": ("wanted at offset|elements need more than", "ends too early"),
    "bytes left over": ("bytes follow the body", "bytes follow the body"),
    "other code": ("is not the code of", "is another message's"),
    "no code": ("too few for a message code", "cannot hold it"),
    "unknown bit": ("stand for no member", "unknown bits in presence vector"),
    "no such option": ("names no option", "no option|names none"),
    "no such type": ("names no type", "no type|names none"),
    "count too large": ("count .* is more than", "count .* is more than"),
    "count beyond the end": ("needs more than the", "needs more than the"),
    "length too large": ("length .* is more than", "length .* is more than"),
    "length beyond the end": ("bytes that follow", "bytes that follow"),
}
ENCODING = {
    "not legal": ("is not among the legal values", "is outside|is not in the value set"),
    "out of range": ("is outside", "is outside"),
    "number of elements": ("elements instead of", "length .* is outside"),
    "count not legal": ("count .* is outside", "length .* is outside"),
    "length not legal": ("length .* is outside", "length .* is outside"),
    "too long": ("characters do not fit", "length .* is outside"),
    "NUL": ("has a NUL", "has a NUL"),
    "not Latin-1": ("beyond Latin-1", "beyond Latin-1"),
    "no such type": ("names no type", "no type|names none"),
}


class Interpreted:
    """Reads and writes by the interpreting codec."""

    errors = (messages.DecodeError, messages.EncodeError)
    words = 0

    def __init__(self, vector):
        self._entry = catalogue(vector["model"]).message(vector["message"])

    def decode(self, data):
        return self._entry.decode(data, as_it_is)

    def encode(self, fields):
        return self._entry.encode(fields)


class Generated:
    """Reads and writes by the generated class."""

    errors = (wire.DecodeError, wire.EncodeError)
    words = 1

    def __init__(self, vector):
        views, module = generated(vector["model"])
        view = next(view for view in views if view.jaus_name == vector["message"])
        self._names = FieldNames(view, module)

    def decode(self, data):
        return self._names.to_fields(self._names.cls.decode(data))

    def encode(self, fields):
        return self._names.from_fields(fields).encode()


@functools.cache
def catalogue(model):
    return load_catalogue([ROOT / model])


@functools.cache
def generated(model):
    set_name = next((key for key, file in LIBRARY_FILES.items() if model.endswith(f"/{file}")), "")
    if set_name:
        views, _, module = library(set_name)
        return views, module
    views = read_messages(ROOT / model)
    return views, load(render(views), f"vectors_{re.sub('[^a-z]', '_', model)}")


@for_each(
    ("codec", "vector"),
    [(codec, vector) for codec in (Interpreted, Generated) for vector in vectors()],
    ids=lambda pair: f"{pair[0].__name__}: {pair[1]['name']}",
    shards=2,
)
def test_each_codec_does_as_the_vector_says(codec, vector):
    tested = codec(vector)
    data = payload_of(vector)
    if "error" not in vector:
        assert close(tested.decode(data), vector["fields"])
        if given(vector) is not None:
            assert tested.encode(given(vector)) == data
        return
    kind, (decode_error, encode_error) = vector["error"]["kind"], codec.errors
    if data is not None:
        with pytest.raises(decode_error, match=DECODING[kind][codec.words]) as caught:
            tested.decode(data)
    else:
        with pytest.raises(encode_error, match=ENCODING[kind][codec.words]) as caught:
            tested.encode(vector["fields"])
    if codec is Interpreted:
        assert caught.value.path == vector["error"]["at"]


def test_the_vectors_cover_every_kind_of_error():
    found = [
        vector["error"]["kind"] for vector in vectors() if "error" in vector and "payload" in vector
    ]
    assert set(found) == set(DECODING)
    found = [
        vector["error"]["kind"] for vector in vectors() if "error" in vector and "fields" in vector
    ]
    assert set(found) == set(ENCODING)
