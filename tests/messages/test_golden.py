"""The interpreting codec against the bytes that other implementations made."""

import json

import pytest
from wire_vectors import close, golden_vectors

from jausml.live.messages import AmbiguousMessageError
from jausml.live.messages.catalogue import as_it_is

pytestmark = pytest.mark.beside("golden/jaus_messages.jsonl")


def test_every_vector_decodes_to_its_fields_and_back_to_its_bytes(catalogue):
    wrong = []
    for vector in golden_vectors():
        service = f"{vector['service']}/{vector['service_version']}"
        entry = catalogue.message(vector["message"], service)
        data = bytes.fromhex(vector["hex"])
        fields = entry.decode(data, as_it_is)
        again = entry.encode(vector["fields"])
        if (
            not close(fields, vector["fields"])
            or again != data
            or entry.code != data[0] + 256 * data[1]
        ):
            wrong.append((vector["message"], vector["hex"], fields, again.hex()))
    assert not wrong


def test_what_is_printed_is_encoded_to_the_same_bytes(catalogue):
    """Without a service, too: the printed line names one."""
    ambiguous = set()
    for vector in golden_vectors():
        data = bytes.fromhex(vector["hex"])
        try:
            decoded = catalogue.decode(data)
        except AmbiguousMessageError:
            ambiguous.add(vector["id"])
            continue
        assert decoded.entry.name == vector["message"]
        assert catalogue.encode(json.loads(json.dumps(decoded.to_json()))) == data
    assert ambiguous <= {"0x2602", "0x4602", "0x4600", "0x4632", "0xF92A", "0xF932"}


def test_presence_vectors_may_be_left_out(catalogue):
    def bare(value):
        if isinstance(value, dict):
            return {key: bare(field_value) for key, field_value in value.items() if key != "_pv"}
        return [bare(item) for item in value] if isinstance(value, list) else value

    for vector in golden_vectors():
        if "_pv" in json.dumps(vector["fields"]):
            service = f"{vector['service']}/{vector['service_version']}"
            entry = catalogue.message(vector["message"], service)
            assert entry.encode(bare(vector["fields"])).hex() == vector["hex"]
