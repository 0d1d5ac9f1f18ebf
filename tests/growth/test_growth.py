"""What the verbs cost as a model grows in each dimension: no more than n log n.

It is counted in calls of each function: one that goes through all elements for each of them is seen
in small models, where what all others do would hide it.
"""

import importlib.util
from functools import lru_cache
from itertools import count
from pathlib import Path

import pytest
from counting import calls
from sweeps import sweep

from jausml.authoring.editor.completion import complete
from jausml.authoring.editor.definition import outline
from jausml.authoring.editor.hover import hover
from jausml.authoring.editor.places import Place
from jausml.authoring.editor.workbench import Workbench, all_problems
from jausml.generation.rendering import render
from jausml.generation.target import load_targets
from jausml.generation.workspace import select
from jausml.language.metamodel.classes import system
from jausml.language.model.xmi.writer import to_xmi
from jausml.language.text.reading.parsing import parse
from jausml.language.text.writing.layout import lay_out
from jausml.language.text.writing.unparsing import to_text
from jausml.language.validation.engine import check_project
from jausml.views.analysis.report import report_of
from jausml.views.analysis.sizes import Assumptions
from jausml.views.diagrams.views import graph_of
from jausml.views.diagrams.writers.text import render_mermaid

_SPEC = importlib.util.spec_from_file_location("grown", Path(__file__).with_name("grown.py"))
grown = importlib.util.module_from_spec(_SPEC)
_SPEC.loader.exec_module(grown)

TARGETS = ("bridge", "jaus_component", "messages", "ros_interfaces")
LIVING = (
    grown.messages,
    grown.connections,
    grown.commands,
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
GUARDING = (grown.commands, grown.states, grown.components, grown.lines)
VIEW = {grown.states: "machine:M", grown.transitions: "machine:M", grown.messages: "service:S"}
MAPS = (grown.assignments, grown.ros_fields, grown.ros_structures, grown.table)


class Grown:
    """The models of one dimension, each read once for all that is done with it."""

    def __init__(self, dimension, folder):
        self.folder, self.dimension = folder, dimension
        self.letters, self.benches = count(), {}
        self.read = lru_cache(self._read)
        self.as_text = lru_cache(self._as_text)

    def _read(self, size):
        """Returns how many calls it took to read and judge a model, and what was found."""
        path, reports = self.folder / f"grown_{size}.xmi", []
        path.write_text(grown.model(self.dimension(size)), "utf-8")
        return calls(lambda: reports.append(check_project([path]))), reports[0]

    def _as_text(self, size):
        _, report = self.read(size)
        target = self.folder / f"grown_{size}.ros2jaus"
        target.write_text(to_text(report.model.documents[0].roots, report.model, target), "utf-8")
        return target

    def validation(self, size):
        return self.read(size)[0]

    def text(self, size):
        path, bench = self.as_text(size), Workbench()
        bench.texts[path] = path.read_text("utf-8")
        self.benches[size] = bench
        return calls(lambda: all_problems(bench, path))

    def conversion(self, size):
        model = self.read(size)[1].model
        roots, path = model.documents[0].roots, self.folder / "grown.xmi"
        return calls(lambda: (to_text(roots, model, path), to_xmi(roots, model, path)))

    def format(self, size):
        text = self.as_text(size).read_text("utf-8")
        return calls(lambda: lay_out(parse(text).document))

    def diagram(self, size):
        shown = "map:map" if self.dimension in MAPS else VIEW.get(self.dimension, "system")
        _, report = self.read(size)
        return calls(lambda: render_mermaid(graph_of(report.model, shown, report.diagnostics)))

    def generation(self, size):
        targets = select(load_targets(), TARGETS).targets
        _, report = self.read(size)
        assert not report.has_errors, report.diagnostics[:3]
        return calls(lambda: render(report.model, targets))

    def report(self, size):
        (made,) = self.read(size)[1].model.instances(system.System)
        return calls(lambda: report_of(made, Assumptions()))

    def a_letter_in_an_editor(self, size):
        path, bench = self.as_text(size), self.benches[size]
        started = f"component another_{next(self.letters)} {{\n  addre\n}}\n"
        bench.texts[path] = started + path.read_text("utf-8")

        def letter():
            outline(bench.texts[path])
            complete(bench, path, Place(2, 7))
            hover(bench, path, Place(1, 3))
            all_problems(bench, path)

        return calls(letter)


VERBS = {
    Grown.validation: (*ALL, grown.ends_of_a_topic, grown.doubling_ros_types),
    Grown.conversion: ALL,
    Grown.text: ALL,
    Grown.format: ALL,
    Grown.diagram: (*LIVING, grown.components, grown.nodes),
    # Tests that are generated for a machine walk to each of its states, up to a number of steps:
    # up to there each walk is longer.
    Grown.generation: [one for one in LIVING if one is not grown.states],
    Grown.report: (grown.connections, grown.service_connections, grown.components, grown.nodes),
    Grown.a_letter_in_an_editor: ALL,
}
SMALL = 10


def assert_growth(cost):
    """Asserts that what is added by doubling twice is no more than n log n adds, for each function.

    From the differences what does not grow is gone; n log n doubles, and 14 to 16 % more.
    """
    cost(2)  # what is remembered of the library is remembered
    few, more, most = cost(SMALL), cost(2 * SMALL), cost(4 * SMALL)
    too_many = {
        function: (few[function], more[function], most[function])
        for function in most
        if most[function] - more[function] > 2.3 * (more[function] - few[function]) + 50
    }
    assert too_many == {}


@pytest.mark.timeout(300)
@pytest.mark.parametrize(
    "dimension",
    sweep(
        [*ALL, grown.ends_of_a_topic, grown.doubling_ros_types], every=lambda one: one in GUARDING
    ),
    ids=lambda one: one.__name__,
)
def test_each_verb(dimension, tmp_path, subtests):
    models = Grown(dimension, tmp_path)
    models.read(1)  # each is read once: what is remembered is remembered before any counts
    for verb, dimensions in VERBS.items():
        if dimension in dimensions:
            with subtests.test(verb.__name__):
                assert_growth(lambda size, verb=verb: verb(models, size))


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

    assert_growth(cost)


def test_imports_of_a_text(tmp_path):
    def cost(size):
        for i in range(size):
            (tmp_path / f"t{i}.ros2jaus").write_text(f"component c{i} {{ address: 1.1.{i + 1} }}\n")
        imports = "".join(f'import "t{i}.ros2jaus"\n' for i in range(size))
        path = tmp_path / "all.ros2jaus"
        path.write_text(f"{imports}system all {{ }}\n", "utf-8")
        return calls(lambda: check_project([path]))

    assert_growth(cost)


def test_components_that_share_messages_compare_each_once(tmp_path):
    """Two services have the same messages, which only their layouts tell."""

    def described(count):
        twice = grown.service(grown.octets(20)) + grown.service(grown.octets(20)).replace(
            'xmi:id="s" name="S" urn="urn:example:a:S"', 'xmi:id="t" name="T" urn="urn:example:a:T"'
        ).replace('name="set"', 'name="other"')
        users = grown.components(count).replace("/>", ' provides="s t"/>')
        path = tmp_path / "shared.xmi"
        path.write_text(grown.model(users + twice), "utf-8")
        counted = calls(lambda: check_project([path]))
        return sum(n for name, n in counted.items() if name.endswith(" comparable"))

    assert described(12) == described(2) > 0
