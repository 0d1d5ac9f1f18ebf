"""Models that share the documents of the library are what they are without sharing."""

import os
import shutil
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Barrier

import pytest
from sweeps import sweep

from jausml.language.metamodel.classes import jaus
from jausml.language.model import Model, library_root, names, read_models, uris
from jausml.language.model.comparison import compare
from jausml.language.model.library import LIBRARY_URI
from jausml.language.model.reading.library_cache import LibraryCache
from jausml.language.text.notation import Ros2Jaus

ROOT = Path(__file__).resolve().parents[2]
NOTATIONS = (Ros2Jaus(),)
MODELS = sorted(
    path
    for pattern in ("*.xmi", "*.ros2jaus")
    for path in (ROOT / "models").rglob(pattern)
    if "library" not in path.parts
)
COMPONENT = """<?xml version="1.0" encoding="UTF-8"?>
<xmi:XMI xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
 xmlns:jaus="http://www.jausml.org/jaus/1.0">
 <jaus:Component name="sensor" address="10.1.1">
  <provides href="{uri}#VelocityStateSensor"/>
 </jaus:Component>
</xmi:XMI>
"""
OWNER = """<?xml version="1.0" encoding="UTF-8"?>
<jaus:ServiceSet xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
 xmlns:jaus="http://www.jausml.org/jaus/1.0" name="stolen">
  <services href="{uri}#VelocityStateSensor"/>
</jaus:ServiceSet>
"""
MOBILITY = f"{LIBRARY_URI}jaus/mobility.xmi"


def read(path, cache=None, **options):
    return read_models([path], notations=NOTATIONS, cache=cache, **options)


def outline(result):
    """All that can be asked about where things stand, and what was found."""
    model = result.model
    return [
        *(
            (document.display, document.is_library, document.is_input)
            for document in model.documents
        ),
        *result.diagnostics,
        *((str(model.location(element)), model.fragment(element)) for element in model.elements()),
        [model.element_path(message_def) for message_def in model.instances(jaus.MessageDef)],
    ]


def library_of(result):
    return [document for document in result.model.documents if document.is_library]


@pytest.fixture(scope="module")
def cache():
    return LibraryCache()


@pytest.mark.parametrize("path", sweep(MODELS, every=8), ids=lambda library_path: library_path.name)
def test_a_model_is_the_same_whoever_has_read_the_library(path, cache):
    alone, first, again = read(path), read(path, cache), read(path, cache)
    assert outline(first) == outline(alone)
    assert outline(again) == outline(alone)
    for ours, theirs in zip(alone.model.roots, again.model.roots, strict=True):
        assert not compare(ours, theirs, again.model.metamodels)


def write(folder, text, uri=MOBILITY, name="model.xmi"):
    path = folder / name
    path.write_text(text.format(uri=uri), encoding="utf-8")
    return path


def test_elements_of_the_library_are_those_of_all_and_know_none(tmp_path):
    cache, path = LibraryCache(), write(tmp_path, COMPONENT)
    first, again = read(path, cache), read(path, cache)
    assert library_of(first) == library_of(again) != []
    assert first.model.root is not again.model.root
    [service] = again.model.root.provides
    assert service is first.model.root.provides[0]
    assert again.model.is_library(service)
    own = {*first.model.elements(library=False), *again.model.elements(library=False)}
    assert not [owner for owner, _ in service._inverse_rels if owner in own]


def test_what_owns_an_element_of_the_library_has_it_for_itself(tmp_path):
    cache = LibraryCache()
    shared = read(write(tmp_path, COMPONENT), cache)
    path = write(tmp_path, OWNER, name="owner.xmi")
    for _ in range(2):
        result = read(path, cache)
        assert outline(result) == outline(read(path))
        assert library_of(result) != library_of(shared)
    assert library_of(read(tmp_path / "model.xmi", cache)) == library_of(shared)


def test_a_library_that_is_checked_itself_is_read_itself(tmp_path):
    cache = LibraryCache()
    read(write(tmp_path, COMPONENT), cache)
    path = library_root() / "jaus" / "mobility.xmi"
    result = read(path, cache)
    assert result.model.documents[0].is_input
    assert outline(result) == outline(read(path))


def by_another_name(file, folder):
    return os.path.relpath(library_root() / "jaus" / file, folder)


def test_the_same_library_by_another_name_is_called_by_that_and_kept_too(tmp_path):
    cache = LibraryCache()
    shared = read(write(tmp_path, COMPONENT), cache)
    path = write(tmp_path, COMPONENT, by_another_name("mobility.xmi", tmp_path), "other.xmi")
    options = {"allow_outside": True, "project_root": tmp_path}
    first, again = read(path, cache, **options), read(path, cache, **options)
    assert outline(first) == outline(again) == outline(read(path, **options))
    assert library_of(first) == library_of(again) != library_of(shared)
    assert library_of(read(tmp_path / "model.xmi", cache)) == library_of(shared)


@pytest.mark.parametrize("is_known", [True, False])
def test_a_library_of_two_names_in_a_model_is_one(tmp_path, is_known):
    cache = LibraryCache()
    if is_known:
        read(write(tmp_path, COMPONENT), cache)
    core = by_another_name("core-1.0.xmi", tmp_path)
    both = COMPONENT.replace("<provides", f'<provides href="{core}#Management"/><provides', 1)
    path = write(tmp_path, both, name="other.xmi")
    options = {"allow_outside": True, "project_root": tmp_path}
    for _ in range(2):
        result = read(path, cache, **options)
        assert outline(result) == outline(read(path, **options))
        management, sensor = result.model.root.provides
        assert top_of(management) is top_of(sensor)


def top_of(service):
    return service if service.inherits is None else top_of(service.inherits)


def test_a_library_with_a_finding_is_not_kept(tmp_path, monkeypatch):
    cache, path = LibraryCache(), write(tmp_path, COMPONENT)
    library = other_library(tmp_path, monkeypatch)
    core = library / "jaus" / "core-1.0.xmi"
    core.write_text(
        core.read_text(encoding="utf-8").replace("<services ", "<servicez ", 1), encoding="utf-8"
    )
    first, again = read(path, cache), read(path, cache)
    assert outline(first) == outline(again) == outline(read(path))
    assert again.has_errors
    assert library_of(first) != library_of(again)


def test_a_library_that_has_changed_is_read_again(tmp_path, monkeypatch):
    cache, path = LibraryCache(), write(tmp_path, COMPONENT)
    mobility = other_library(tmp_path, monkeypatch) / "jaus" / "mobility.xmi"
    before = read(path, cache)
    text = mobility.read_text(encoding="utf-8")
    mobility.write_text(text.replace("VelocityStateSensor", "OtherSensor"), encoding="utf-8")
    after = read(path, cache)
    assert not before.has_errors
    assert after.has_errors
    assert outline(after) == outline(read(path))


def other_library(folder, monkeypatch):
    """A copy of the library that may be changed."""
    library = folder / "library"
    shutil.copytree(library_root(), library)
    monkeypatch.setattr(uris, "library_root", lambda: library)
    return library


def test_the_next_reading_walks_nothing_of_the_library(tmp_path, monkeypatch):
    """Neither for names, nor for the elements of a class, nor to keep what it has."""
    path, cache, walked = tmp_path / "a.ros2jaus", LibraryCache(), []
    elements_of = Model.elements_of

    def walk(self, document):
        walked.append(document)
        return elements_of(self, document)

    monkeypatch.setattr(Model, "elements_of", walk)
    found = []
    for address in ("10.1.1", "10.1.2"):
        walked.clear()
        path.write_text(f"component one {{ address: {address} provides: VelocityStateSensor }}")
        result = read(path, cache)
        assert not result.diagnostics
        found.append([message_def.name for message_def in result.model.instances(jaus.MessageDef)])
        shared = [document for document in walked if document.is_shared]
        assert bool(shared) == (address == "10.1.1")
    assert found[0] == found[1] != []


@pytest.mark.parametrize("path", sweep(MODELS, every=6), ids=lambda path: path.name)
def test_what_an_element_owns_is_of_a_class_that_it_may_own(path):
    model = read(path).model
    class_of = model.metamodels.class_of
    for element in model.elements():
        held = names.held_by(model.metamodels, class_of(element))
        for owned in model.owned(element):
            table = class_of(owned)
            assert {table, *table.supertypes} <= held
            assert names.held_by(model.metamodels, table) <= held


# -- several threads -------------------------------------------------------------------------------


THREADS = 4


@pytest.fixture
def hasty():
    """Threads that take turns as often as they can."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1e-6)
    yield
    sys.setswitchinterval(before)


@pytest.mark.usefixtures("hasty")
def test_all_threads_find_all_instances():
    model = read_models([library_root() / "jaus" / "mobility.xmi"]).model
    begin = Barrier(THREADS)

    def count(_):
        begin.wait()
        return len(model.instances(jaus.MessageDef))

    with ThreadPoolExecutor(THREADS) as threads:
        counts = set(threads.map(count, range(THREADS)))
    assert counts == {len(model.instances(jaus.MessageDef))}
    assert counts != {0}
