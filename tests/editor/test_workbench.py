"""The workbench: texts are parsed once, whoever asks."""

import sys
from collections import Counter
from pathlib import Path

import pytest

from jausml.authoring.editor.definition import outline
from jausml.authoring.editor.workbench import Workbench, all_problems, syntax_problems
from jausml.language.model import read_models
from jausml.language.text.reading import parsing

EXAMPLES = Path(__file__).parents[2] / "models" / "examples"
TEXTS = sorted(EXAMPLES.rglob("*.ros2jaus"))


def parts(parsed):
    return parsed.document, parsed.faults, parsed.tokens


@pytest.fixture
def bench():
    return Workbench()


@pytest.mark.parametrize("path", TEXTS, ids=lambda text_path: text_path.stem)
def test_reading_leaves_the_tree_as_it_was_parsed(bench, path):
    text = path.read_text(encoding="utf-8")
    bench.texts[path.resolve()] = text
    all_problems(bench, path.resolve())

    assert parts(parsing.parsed_text(text)) == parts(parsing.parse(text))


def test_a_text_is_parsed_once_for_all_that_is_asked(bench, tmp_path):
    path = tmp_path / "robot.ros2jaus"
    text = "// This text alone.\n" + TEXTS[0].read_text(encoding="utf-8")
    parsed = Counter()

    def counted(frame, event, _argument):
        if event == "call" and frame.f_code is parsing.parse.__code__:
            parsed[frame.f_locals["text"]] += 1

    sys.setprofile(counted)
    try:
        bench.texts[path] = text
        assert syntax_problems(text) == []
        all_problems(bench, path)
        outline(text)
    finally:
        sys.setprofile(None)
    assert any(source.startswith("// This text alone.") for source in parsed)
    assert set(parsed.values()) == {1}


def test_a_letter_has_nothing_of_the_library_read_again(bench, tmp_path, monkeypatch):
    monkeypatch.setitem(read_models.__kwdefaults__, "cache", None)  # which tests share
    path, found, libraries = tmp_path / "robot.ros2jaus", [], []
    text = TEXTS[0].read_text(encoding="utf-8")
    for version in (text, f"{text}// a", f"{text}// ab"):
        bench.texts[path] = version
        found.append(all_problems(bench, path))
        documents = bench._models[path].documents
        libraries.append(
            {document for document in documents if document.is_library and document.is_xml}
        )
    assert libraries[0]
    assert libraries[0] == libraries[1] == libraries[2]
    assert found[0] == found[1] == found[2]
