"""Benchmarks: what they import is there, each of them works, and the page is that of its data."""

from __future__ import annotations

import ast
import importlib
import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path

import needs
import pytest
from for_each import for_each
from sweeps import sweep

from jausml.language.model import library_root

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "benchmarks"
RUN = FOLDER / "run.py"
SECTIONS = (
    "translations",
    "latency",
    "connections",
    "events",
    "throughput",
    "load",
    "grids",
    "partition",
    "footprint",
    "hosts",
    "components",
    "one_processor",
    "codecs",
    "toolchain",
    "studio",
    "letters",
)


@pytest.fixture
def page(monkeypatch):
    """The module that makes the page."""
    monkeypatch.syspath_prepend(str(FOLDER))
    return importlib.import_module("page")


@for_each("path", sorted(FOLDER.glob("*.py")), ids=lambda path: path.stem)
def test_what_it_imports_is_there(path):
    lost = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("jausml"):
            # The copy of the runtime in a workspace is the runtime.
            module = importlib.import_module(
                node.module.replace("jausml_runtime", "jausml.runtime")
            )
            lost += [each.name for each in node.names if not _has(module, each.name)]
    assert lost == []


def _has(module, name):
    """Whether a module has a name, or a package a module."""
    return hasattr(module, name) or importlib.util.find_spec(f"{module.__name__}.{name}")


def test_the_ready_maps_are_there(monkeypatch):
    monkeypatch.syspath_prepend(str(FOLDER))
    systems, names = map(importlib.import_module, ("systems", "names"))
    assert systems.READY.keys() == names.READY_MAPS.keys()
    for name, file in systems.READY.items():
        text = (library_root() / "mappings" / f"{file}.ros2jaus").read_text(encoding="utf-8")
        assert f"\n{name} {{" in text


def test_the_page_is_made_of_the_data(page):
    data = page.stored(FOLDER / "results.json")
    for name, text in page.files(data).items():
        assert (ROOT / "docs" / name).read_text(encoding="utf-8") == text, name


@for_each("path", sorted(FOLDER.glob("*.json")), ids=lambda path: path.stem)
def test_the_data_tells_nothing_of_the_computer(path):
    text = path.read_text(encoding="utf-8")
    assert str(ROOT) not in text
    assert os.uname().nodename not in text


def test_a_page_without_data_has_its_targets(page):
    machine = {"python": "3.11.0", "processors": 2}
    failed = {"load": "exit code 1"}
    data = {"sections": {}, "runs": {}, "failed": failed, "machine": machine}
    files = page.files(data)
    assert list(files) == ["performance.md"]
    assert "not measured" in files["performance.md"]
    assert "- load: exit code 1" in files["performance.md"]


def test_a_missed_target_is_told_with_its_reason(page, monkeypatch):
    targets = importlib.import_module("targets")
    monkeypatch.setattr(page, "REMARKS", {"round_trip": "two loops wake up."})
    machine = {"python": "3.11.0", "processors": 2}
    figures = {"median": 90.0, "tail": 120.0, "ratio": 3.1, "span": [2.9, 3.4], "tail_ratio": 3.0}
    sections = {"components": {"messages": figures}}
    data = {"sections": sections, "runs": {}, "failed": {}, "machine": machine}
    text = page.files(data)["performance.md"]
    assert "| at most 2 x | 3.1 x (messages) | **missed** |" in text
    assert ": two loops wake up." in text
    assert {each.key for each in targets.TARGETS} >= set(targets.REMARKS)


def test_what_is_of_no_full_run_is_told_where_it_stands(page):
    figures = {"median": 90.0, "tail": 120.0}
    sections = {"components": {"messages": figures}, "one_processor": {"messages": figures}}
    runs = {
        "components": {"scale": "full", "load": 0.2},
        "one_processor": {"scale": "quick", "load": 8.5},
    }
    machine = {"python": "3.11.0", "processors": 2}
    data = {"sections": sections, "runs": runs, "failed": {}, "machine": machine}
    beginning, _, part = page.files(data)["performance.md"].partition("## Between")
    for each in (beginning, part):
        assert "**Of no full run**: one_processor (quick)." in each
        assert "had other work**: one_processor (load 8.5)." in each


def test_variants_stand_in_tables_that_measured_them(page):
    floor, compiled = {"median": 200.0}, {"ratio": 0.8, "tail_ratio": 0.9}
    found = {"10": {way: {"floor": floor, "compiled": compiled} for way in ("up", "down")}}
    machine = {"python": "3.11.0", "processors": 2}
    data = {"sections": {"events": found}, "runs": {}, "failed": {}, "machine": machine}
    text = page.files(data)["performance.md"]
    assert "| event | a second | floor, us | compiled | compiled, p99 against p99 |" in text
    assert "| JAUS to ROS | 10 | 200 | 0.80 | 0.9 |" in text


def test_the_page_on_faults_is_made_of_the_data(monkeypatch):
    monkeypatch.syspath_prepend(str(FOLDER))
    fault_page = importlib.import_module("fault_page")
    data = json.loads(fault_page.DATA.read_text(encoding="utf-8"))
    assert fault_page.PAGE.read_text(encoding="utf-8") == fault_page.page(data)
    bounds = json.loads(fault_page.BOUNDS.read_text(encoding="utf-8"))
    assert fault_page.exceeded(data, bounds) == []
    assert bounds["recovered"].keys() - {""} <= data["faults"].keys()


def test_what_comes_back_too_late_is_told(monkeypatch):
    monkeypatch.syspath_prepend(str(FOLDER))
    fault_page = importlib.import_module("fault_page")
    found = {"recovered": {"drive": 3.0, "pose": 1.0}, "stopped": {"drive": 0.5}}
    bounds = {"recovered": {"": 9.0, "cut": 2.0}, "stopped": {"": 0.4}}
    told = fault_page.exceeded({"faults": {"cut": found, "lost": found}}, bounds)
    assert told == [
        "cut: drive stopped after 0.5 s, the bound is 0.4 s",
        "cut: drive recovered after 3 s, the bound is 2 s",
        "lost: drive stopped after 0.5 s, the bound is 0.4 s",
    ]


@pytest.fixture
def soak(monkeypatch):
    """The module of the soak."""
    needs.ask("rclpy")
    monkeypatch.syspath_prepend(str(FOLDER))
    return importlib.import_module("soak")


def looks(step, **last):
    found = [
        {"seconds": 10 * n, "memory_mib": 70 + step * n, "descriptors": 20, "threads": 17}
        for n in range(40)
    ]
    found[-1] |= last
    return found


def soaked(soak, seen, **more):
    ways = {"up": {"sent": 9, "received": 8, "lost": 1}}
    found = {"looks": seen, "grown_mib": soak.grown(seen), "ways": ways, "exit_code": 0}
    found["account"] = {"sent": 9, "came": 8, "lost": 1}
    return {**found, **more}


def test_a_short_soak_does_not_replace_what_the_page_tells(soak):
    assert soak.data_file(1.0).parent == soak.LOOKS
    assert soak.data_file(60.0) == soak.DATA


def test_a_soak_that_stays_as_it_was_is_good(soak):
    assert soak.faults(soaked(soak, looks(0.0))) == []


def test_a_soak_tells_what_grows_and_what_is_missing(soak):
    ways = {"up": {"sent": 9, "received": 7, "lost": 1}}
    seen = looks(0.1, descriptors=21, threads=18)
    account = {"sent": 9, "came": 7, "lost": 1}
    assert soak.faults(soaked(soak, seen, ways=ways, account=account, exit_code=1)) == [
        f"the memory has grown by {soak.grown(seen):g} MiB",
        "descriptors have grown from 20 to 21",
        "threads have grown from 17 to 18",
        "up: 1 of 9 messages are missing unseen",
        "9 packets were sent, the bridge knows of 8",
        "the bridge ended with 1",
    ]


def test_all_sections_are_known():
    found = subprocess.run([sys.executable, RUN, "--list"], capture_output=True, text=True)
    assert tuple(found.stdout.split()) == SECTIONS


@pytest.mark.live
@pytest.mark.timeout(300)
@pytest.mark.needs("compiler")
@pytest.mark.parametrize("section", sweep(SECTIONS, every=lambda name: name == "codecs"))
def test_each_section_measures(section, tmp_path):
    data, written = tmp_path / "results.json", tmp_path / "performance.md"
    command = [sys.executable, RUN, "--tiny", "--only", section, "--data", data, "--page", written]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert json.loads(data.read_text(encoding="utf-8"))["sections"][section]
    assert written.read_text(encoding="utf-8").startswith("# What it costs")
