"""Messages that proofs begin with, against the codec of the live tools."""

from contextlib import suppress
from pathlib import Path

import pytest

from jausml.language import wire
from jausml.language.metamodel.classes import jaus
from jausml.live.messages import MessageError, load_catalogue
from jausml.live.messages.defined import DefinedCatalogue
from jausml.proving.layout import Usual, jaus_layout

EVERY_KIND = Path(__file__).parent.parent / "generators" / "every_kind.xmi"


@pytest.fixture(scope="module")
def catalogue() -> DefinedCatalogue:
    return load_catalogue([EVERY_KIND])


def _whole(catalogue: DefinedCatalogue, code: int, data: bytes) -> bool:
    """Tells whether one of the messages of a code is in some bytes, to the last one."""
    for entry in catalogue.find(code):
        with suppress(MessageError):
            if entry.encode(entry.decode(data)) == data:
                return True
    return False


@pytest.mark.parametrize("option", range(3))
def test_usual_messages_are_whole_ones(catalogue: DefinedCatalogue, option: int) -> None:
    """Each is decoded to its last byte, and encoded to the same ones; so is what it is read of."""
    tried = 0
    for message in catalogue.model.instances(jaus.MessageDef):
        resolved = wire.resolve(message)
        layout = jaus_layout(resolved, usual=Usual(option=option))
        assert _whole(catalogue, resolved.code, layout.data), message.name
        assert jaus_layout(resolved, layout.data) == layout, message.name
        tried += 1
    assert tried > 250
