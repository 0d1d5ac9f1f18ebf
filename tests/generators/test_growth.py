"""How generation grows with the model, in calls of Python functions: no clock is asked."""

from __future__ import annotations

import importlib.util
from pathlib import Path

import pytest
from counting import calls as counted
from sweeps import sweep

from jausml.generation import load_targets, render, select
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
    model = folder / "grown.xmi"
    model.write_text(text, encoding="utf-8")
    report = check_project([model])
    assert not report.has_errors, report.diagnostics[:3]
    return counted(lambda: work(report.model)).total()


@pytest.mark.parametrize(
    ("own_maps", "own_frames"), sweep([(True, True), (True, False), (False, False)], every=3)
)
def test_generation_is_linear_in_connections(growth, tmp_path, own_maps, own_frames):
    few, more, most = (
        calls(growth.connections(n, own_maps=own_maps, own_frames=own_frames), tmp_path)
        for n in (1, 31, 91)
    )
    assert most - few < 3.3 * (more - few)


def test_the_list_of_processes_translates_nothing(growth, tmp_path):
    few, many = (calls(growth.connections(n, own_maps=True), tmp_path, processes) for n in (1, 31))
    assert many < few + 31


@pytest.mark.slow
def test_generation_is_not_exponential_in_nesting(growth, tmp_path):
    few, more, most = (calls(growth.nested(n), tmp_path) for n in (20, 40, 60))
    assert most - more < 2 * (more - few)


@pytest.mark.slow
def test_generation_is_no_more_than_fields_in_types_that_double(growth, tmp_path):
    few, more = (calls(growth.doubling(n), tmp_path) for n in (8, 9))
    assert more < 2.2 * few
