"""Codecs in C++ of the messages that the library ships: what is printed of them can be compiled."""

from contextlib import suppress
from pathlib import Path

import pytest
from codec_support import definitions, shipped_sets
from scripts import succeeded
from sweeps import sweep

from jausml.generation.native import FLAGS, compiler
from jausml_generators.cpp import jaus_codec
from jausml_generators.cpp.types import UnprintableError

GUARDS = ("generators/jausml_generators/cpp", "models/library/jaus")

SUPPORT = Path(jaus_codec.__file__).parent / "templates"
CHECKED = ("-fsyntax-only", "-Wall", "-Wextra", "-Werror")


@pytest.mark.needs("compiler")
@pytest.mark.parametrize("name", sweep(shipped_sets(), every=8))
def test_messages_compile(name, tmp_path):
    codec = jaus_codec.JausCodec()
    for view in dict.fromkeys(definitions(name).values()):
        with suppress(UnprintableError):
            codec.add(view)
    assert codec.structs
    lines = ['#include "core.hpp"', "namespace jaus {", *codec.lines, "}", ""]
    source = tmp_path / "messages.cpp"
    source.write_text("\n".join(lines), encoding="utf-8")
    command = [str(compiler()), *FLAGS, *CHECKED, f"-I{SUPPORT}", str(source)]
    succeeded(command)
