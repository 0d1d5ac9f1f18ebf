"""Our codecs against the bytes that other implementations made."""

from typing import Any

import pytest
from codec_nearness import coded_values
from codec_support import FieldNames, library, shipped_sets
from for_each import for_each
from wire_vectors import close, golden_vectors

from jausml.runtime.wire.codec import scaled
from jausml_generators.python.codec.scalars import Bits

pytestmark = pytest.mark.beside("golden/jaus_messages.jsonl")


def candidates(vector: dict[str, Any]) -> list[FieldNames]:
    views, _, module = library(vector["set"])
    code = int(vector["id"], 16)
    found = [v for v in views if v.jaus_name == vector["message"] and v.code == code]
    assert found, "the library lacks the message"
    return [FieldNames(view, module) for view in found]


def problems(names: FieldNames, vector: dict[str, Any]) -> list[str]:
    data = bytes.fromhex(vector["hex"])
    message = names.cls.decode(data)
    found = []
    if not close(names.to_fields(message), vector["fields"]):
        found.append(f"decoded {names.to_fields(message)}")
    if message.encode() != data:
        found.append(f"encoded again {message.encode().hex()}")
    encoded = names.from_fields(vector["fields"]).encode()
    if encoded != data:
        found.append(f"encoded {encoded.hex()}")
    return found


@for_each("set_name", shipped_sets())
def test_every_vector_decodes_to_its_fields_and_back_to_its_bytes(set_name):
    wrong = []
    vectors = [vector for vector in golden_vectors() if vector["set"] == set_name]
    for vector in vectors:
        found = [problems(names, vector) for names in candidates(vector)]
        if all(found):
            wrong.append((vector["message"], vector["hex"], vector["fields"], found))
    assert not wrong
    assert vectors


def steps(value: Any) -> tuple[float, float, int]:
    """Returns lower limit, step and largest integer of a scaled field."""
    lower, upper = value.scale
    largest = 2 ** (8 * value.size) - 1
    return lower, (upper - lower) / largest, largest


@for_each("set_name", shipped_sets())
def test_coded_values_are_the_integers_of_the_other_implementation(set_name):
    checked = 0
    for vector in (
        golden_vector for golden_vector in golden_vectors() if golden_vector["set"] == set_name
    ):
        for names in candidates(vector):
            found = coded_values(names.view, names.cls.decode(bytes.fromhex(vector["hex"])))
            assert len(found) == len(vector["raw"])
            for (value, content), raw in zip(found, vector["raw"].values(), strict=True):
                if isinstance(value, Bits):
                    assert content.to_integer() == raw
                    continue
                lower, step, largest = steps(value)
                assert content == pytest.approx(lower + raw * step, abs=1e-9 * step * largest)
                # That implementation cuts off: what it was given lies up to a step above, and a
                # rounding encoder makes of it the same integer or the next one.
                given = min(content + 0.999 * step, value.scale[1])
                assert scaled(given, lower, step, largest, "") - raw in (0, 1)
                assert scaled(content, lower, step, largest, "") == raw
                checked += 1
    assert checked or set_name.startswith("core")
