"""How generation grows with the model, in calls of Python functions: no clock is asked."""

import importlib.util
from pathlib import Path

import pytest
from counting import calls as counted
from sweeps import sweep

from jausml.generation.rendering import render
from jausml.generation.target import load_targets
from jausml.generation.workspace import select
from jausml.language.validation.engine import check_project
from jausml_generators.bringup.target import processes

TARGETS = ("bridge", "jaus_component", "messages", "bringup")
GROWTH = Path(__file__).parents[2] / "benchmarks" / "growth.py"


@pytest.fixture(scope="module")
def growth(tmp_path_factory):
    """The benchmark, which makes the models, when what a process does once is done."""
    spec = importlib.util.spec_from_file_location("growth", GROWTH)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    calls(module.connections(2, own_maps=False), tmp_path_factory.mktemp("once"))
    return module


def rendering(model):
    """Renders what belongs to a system."""
    render(model, select(load_targets(), TARGETS).targets)


def calls(text, folder, work=rendering):
    """Returns how many calls some work with a model takes, by default its rendering."""
    return counts(text, folder, work).total()


def counts(text, folder, work=rendering):
    """Returns how often some work with a model calls each function."""
    model = folder / ("grown.xmi" if text.startswith("<") else "grown.ros2jaus")
    model.write_text(text, encoding="utf-8")
    report = check_project([model])
    assert not report.has_errors, report.diagnostics[:3]
    return counted(lambda: work(report.model))


@pytest.mark.parametrize(
    ("own_maps", "own_frames"), sweep([(True, True), (True, False), (False, False)], every=3)
)
def test_generation_is_linear_in_connections(growth, tmp_path, own_maps, own_frames):
    few, more, most = (
        calls(growth.connections(n, own_maps=own_maps, own_frames=own_frames), tmp_path)
        for n in (1, 31, 91)
    )
    assert most - few < 3.3 * (more - few)


def test_generation_is_linear_in_messages(growth, tmp_path):
    few, more, most = (calls(growth.both_ways(n), tmp_path) for n in (1, 16, 46))
    assert most - few < 3.3 * (more - few)


def test_what_is_laid_out_alike_is_made_once(growth, tmp_path):
    """Views of messages are built once each; translations and tests once for their form."""
    few, many = (counts(growth.both_ways(n), tmp_path) for n in (5, 25))
    assert added(few, many, "MessageBuilder.build") == 2 * 20
    for function in ("to_ros", "to_jaus", "sample_of", "forms"):
        assert added(few, many, function) == 0


def added(few, many, function):
    """Returns how often a function is called more."""
    return sum((many - few)[name] for name in many if name.endswith(f" {function}"))


def test_the_list_of_processes_translates_nothing(growth, tmp_path):
    few, many = (calls(growth.connections(n, own_maps=True), tmp_path, processes) for n in (1, 31))
    assert many < few + 31


def service(head, types, body):
    return (
        f'{head}<system:System name="grown"><components name="sensor" address="10.1.1"'
        f' provides="S"/></system:System><jaus:ServiceSet name="grown_services">{types}'
        f'<services xmi:id="S" name="S" urn="urn:x-grown:s"><outputs name="ReportM" code="0xD001">'
        f"{body}</outputs></services></jaus:ServiceSet></xmi:XMI>\n"
    )


def nested(head, depth):
    """Returns a model of a message whose sequences are nested so deep."""
    inside = '<fields xsi:type="jaus:FixedField" name="X" type="uint8"/>'
    inside = f'<fields xsi:type="jaus:Record" name="R">{inside}</fields>'
    for n in range(depth):
        inside = f'<fields xsi:type="jaus:Sequence" name="S{n}">{inside}</fields>'
    return service(head, "", f'<body xsi:type="jaus:Sequence" name="Body">{inside}</body>')


def doubling(head, count):
    """Returns a model of so many types each of which holds the one before it twice."""
    reference = '<fields xsi:type="jaus:TypeReference" name="{name}" target="T{n}"/>'
    types = '<types xsi:type="jaus:Record" xmi:id="T0" name="T0">'
    types += '<fields xsi:type="jaus:FixedField" name="X" type="uint8"/></types>'
    for n in range(1, count + 1):
        both = "".join(reference.format(name=name, n=n - 1) for name in ("First", "Second"))
        types += f'<types xsi:type="jaus:Sequence" xmi:id="T{n}" name="T{n}">{both}</types>'
    body = reference.format(name="Body", n=count).replace("fields", "body")
    return service(head, types, body)


@pytest.mark.slow
def test_generation_is_not_exponential_in_nesting(growth, tmp_path):
    few, more, most = (calls(nested(growth.HEAD, n), tmp_path) for n in (20, 40, 60))
    assert most - more < 2 * (more - few)


@pytest.mark.slow
def test_generation_is_no_more_than_fields_in_types_that_double(growth, tmp_path):
    few, more = (calls(doubling(growth.HEAD, n), tmp_path) for n in (8, 9))
    assert more < 2.2 * few
