"""What the verbs cost as a model grows in each dimension: no more than n log n, in calls."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest
from counting import calls

from jausml.authoring.editor.completion import complete
from jausml.authoring.editor.definition import outline
from jausml.authoring.editor.hover import hover
from jausml.authoring.editor.positions import Place
from jausml.authoring.editor.workbench import Workbench, all_problems
from jausml.generation import load_targets, render, select
from jausml.language.metamodel.classes import system
from jausml.language.model.xmi.writer import to_xmi
from jausml.language.text.reading.parsing import parse
from jausml.language.text.writing.layout import lay_out
from jausml.language.text.writing.unparsing import to_text
from jausml.language.validation.project import check_project
from jausml.views.analysis.assumptions import Assumptions
from jausml.views.analysis.report import report_of
from jausml.views.diagrams.views import graph_of
from jausml.views.diagrams.writers import mermaid

_SPEC = importlib.util.spec_from_file_location("grown", Path(__file__).with_name("grown.py"))
grown = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(grown)

TARGETS = ("bridge", "jaus_component", "messages", "ros_interfaces")
LIVING = (
    grown.messages,
    grown.connections,
    grown.service_connections,
    grown.assignments,
    grown.both_directions,
    grown.ros_fields,
    grown.ros_structures,
    grown.table,
    grown.enumerations,
    grown.records,
    grown.options,
    grown.jaus_types,
    grown.states,
    grown.transitions,
)
ALL = (
    *LIVING,
    grown.components,
    grown.references,
    grown.inheritance,
    grown.nodes,
    grown.ros_types,
    grown.lines,
    grown.one_line,
)


def each_of(dimensions):
    return pytest.mark.parametrize("dimension", dimensions, ids=lambda one: one.__name__)


def read(folder, dimension, size):
    path = folder / f"grown_{size}.xmi"
    path.write_text(grown.model(dimension(size)), "utf-8")
    return path, check_project([path])


def as_text(folder, dimension, size):
    path, report = read(folder, dimension, size)
    target = path.with_suffix(".ros2jaus")
    target.write_text(to_text(report.model.documents[0].roots, report.model, target), "utf-8")
    return target


def assert_growth(cost, small):
    """Asserts that what is added by doubling twice is no more than n log n adds.

    From the differences what does not grow is gone; n log n doubles, and 14 to 16 % more.
    """
    cost(small)  # what is remembered of the library is remembered
    few, more, most = cost(small), cost(2 * small), cost(4 * small)
    assert most - more <= 2.3 * (more - few) + 200, (few, more, most)


@each_of((*ALL, grown.ends_of_a_topic, grown.doubling_ros_types))
def test_validation(dimension, tmp_path):
    def cost(size):
        path, _ = read(tmp_path, dimension, size)
        return calls(lambda: check_project([path]))

    assert_growth(cost, 100)


@each_of(ALL)
def test_text(dimension, tmp_path):
    def cost(size):
        path = as_text(tmp_path, dimension, size)
        return calls(lambda: check_project([path]))

    assert_growth(cost, 50)


@each_of(ALL)
def test_conversion(dimension, tmp_path):
    def cost(size):
        path, report = read(tmp_path, dimension, size)
        roots, model = report.model.documents[0].roots, report.model
        return calls(lambda: (to_text(roots, model, path), to_xmi(roots, model, path)))

    assert_growth(cost, 100)


@each_of(ALL)
def test_format(dimension, tmp_path):
    def cost(size):
        text = as_text(tmp_path, dimension, size).read_text("utf-8")
        return calls(lambda: lay_out(parse(text).document))

    assert_growth(cost, 50)


@each_of((*LIVING, grown.components, grown.nodes))
def test_diagram(dimension, tmp_path):
    view = {grown.states: "machine:M", grown.transitions: "machine:M", grown.messages: "service:S"}
    maps = (grown.assignments, grown.ros_fields, grown.ros_structures, grown.table)
    shown = "map:map" if dimension in maps else view.get(dimension, "system")

    def cost(size):
        _, report = read(tmp_path, dimension, size)
        return calls(lambda: mermaid.render(graph_of(report.model, shown, report.diagnostics)))

    assert_growth(cost, 60)


# Tests that are generated for a machine walk to each of its states, up to a number of steps.
@each_of([one for one in LIVING if one is not grown.states])
def test_generation(dimension, tmp_path):
    targets = select(load_targets(), TARGETS).targets

    def cost(size):
        _, report = read(tmp_path, dimension, size)
        assert not report.has_errors, report.diagnostics[:3]
        return calls(lambda: render(report.model, targets))

    assert_growth(cost, 60)


@each_of((grown.connections, grown.service_connections, grown.components, grown.nodes))
def test_report(dimension, tmp_path):
    def cost(size):
        _, report = read(tmp_path, dimension, size)
        (made,) = report.model.instances(system.System)
        return calls(lambda: report_of(made, Assumptions()))

    assert_growth(cost, 60)


@each_of(ALL)
def test_a_letter_in_an_editor(dimension, tmp_path):
    def cost(size):
        path = as_text(tmp_path, dimension, size)
        bench, text = Workbench(), path.read_text("utf-8")
        bench.texts[path] = text
        all_problems(bench, path)
        bench.texts[path] = f"component another {{\n  addre\n}}\n{text}"

        def letter():
            outline(bench.texts[path])
            complete(bench, path, Place(2, 7))
            hover(bench, path, Place(1, 3))
            all_problems(bench, path)

        return calls(letter)

    assert_growth(cost, 50)


def test_documents_that_refer_to_each_other(tmp_path):
    def cost(size):
        for i in range(size):
            following = f'<inherits href="s{i + 1}.xmi#S"/>' if i + 1 < size else ""
            inner = (
                f'<serviceSets name="set{i}" version="1.0"><services xmi:id="S" name="S{i}"'
                f' urn="urn:example:a:S{i}" version="1.0">{following}</services></serviceSets>'
            )
            (tmp_path / f"s{i}.xmi").write_text(grown.model(inner), "utf-8")
        return calls(lambda: check_project([tmp_path / "s0.xmi"]))

    assert_growth(cost, 25)


def test_imports_of_a_text(tmp_path):
    def cost(size):
        for i in range(size):
            (tmp_path / f"t{i}.ros2jaus").write_text(f"component c{i} {{ address: 1.1.{i + 1} }}\n")
        imports = "".join(f'import "t{i}.ros2jaus"\n' for i in range(size))
        path = tmp_path / "all.ros2jaus"
        path.write_text(f"{imports}system all {{ }}\n", "utf-8")
        return calls(lambda: check_project([path]))

    assert_growth(cost, 25)
