"""Benchmarks: what they import is there, each of them works, and the page is that of its data."""

import ast
import importlib
import importlib.util
import json
import os
import sys
from pathlib import Path

import needs
import pytest
from for_each import for_each
from scripts import succeeded
from sweeps import sweep

ROOT = Path(__file__).resolve().parents[2]
FOLDER = ROOT / "benchmarks"
RUN = FOLDER / "run.py"
SECTIONS = {
    "latency": {"small messages up, compiled, against the floor", "small messages down in Python"},
    "footprint": {"resident memory of a bridge of 20 connections"},
    "components": {"round trip of two components against raw datagrams"},
    "toolchain": {
        "the same against the build before",
        "reading 10,000 elements, and all rules",
        "exponent of growth from 50 to 1,500 connections",
    },
    "studio": {"the same with 1,000 elements"},
}
"""What each section measures at least with the least load."""


@pytest.fixture
def page(monkeypatch):
    """The module that makes the page."""
    monkeypatch.syspath_prepend(str(FOLDER))
    return importlib.import_module("page")


@pytest.fixture
def fault_page(monkeypatch):
    """The module that makes the page on faults."""
    monkeypatch.syspath_prepend(str(FOLDER))
    return importlib.import_module("fault_page")


@for_each("path", sorted(FOLDER.glob("*.py")), ids=lambda path: path.stem)
def test_what_it_imports_is_there(path):
    lost = []
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("jausml"):
            # The copy of the runtime in a workspace is the runtime.
            module = importlib.import_module(
                node.module.replace("jausml_runtime", "jausml.runtime")
            )
            lost += [name.name for name in node.names if not _has(module, name.name)]
    assert lost == []


def _has(module, name):
    """Whether a module has a name, or a package a module."""
    return hasattr(module, name) or importlib.util.find_spec(f"{module.__name__}.{name}")


MACHINE = {"python": "3.11.0", "processors": 2}


def test_a_page_without_data_has_its_targets(page):
    failed = {"latency": "exit code 1"}
    data = {"sections": {}, "runs": {}, "failed": failed, "machine": MACHINE}
    text = page.page(data)
    assert text.count("| not measured |") == len(page.TARGETS)
    assert "- latency: exit code 1" in text


def test_a_target_is_judged_by_its_worst_case(page):
    ways = {"up": {"compiled": {"ratio": 0.8}}}
    latency = {kind: {"100": ways} for kind in ("point", "twist")}
    latency["twist"] = {"100": {"up": {"compiled": {"ratio": 0.9}}}}
    runs = {"latency": {"scale": "quick", "load": 8.5}}
    data = {"sections": {"latency": latency}, "runs": runs, "failed": {}, "machine": MACHINE}
    text = page.page(data)
    assert "| 0.85 x | 0.9 x (twist, JAUS to ROS) | **missed** |" in text
    assert "**Of no full run**: latency (quick)." in text
    assert "**Measured beside other work**: latency (load 8.5)." in text


CUT = {
    "recovered": {"drive": 3.0, "pose": 1.0},
    "stopped": {"drive": 0.5},
    "oldest": {"drive": 0.2, "pose": 0.0},
}
"""What was found of a fault."""


def test_the_page_on_faults_is_made_of_the_data(fault_page, tmp_path, capsys):
    bounds = json.loads(fault_page.BOUNDS.read_text(encoding="utf-8"))
    names = {name for limits in bounds.values() for name in limits} - {""}
    data = {"faults": dict.fromkeys(names, CUT), "stale": 2.5, "machine": MACHINE | {"load": 0.5}}
    file = tmp_path / "faults.json"
    file.write_text(json.dumps(data), encoding="utf-8")
    assert fault_page.main(file) == 0
    lines = file.with_suffix(".md").read_text(encoding="utf-8").splitlines()
    assert lines[0] == "# Faults and their effects"
    assert {f"| {name} | 3 |  |  | 1 |  | drive 0.5 | 0.2 |" for name in names} <= set(lines)
    del data["faults"][min(names)]
    file.write_text(json.dumps(data), encoding="utf-8")
    assert fault_page.main(file) == 1
    assert f"{min(names)}: not provoked" in capsys.readouterr().out


def test_what_comes_back_too_late_is_told(fault_page):
    bounds = {"recovered": {"": 9.0, "cut": 2.0}, "stopped": {"": 0.4}}
    told = fault_page.exceeded({"faults": {"cut": CUT, "lost": CUT}}, bounds)
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
    assert soak.data_file(60.0).parent == soak.RESULTS


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


@pytest.mark.live
@pytest.mark.timeout(600)
@pytest.mark.needs("compiler")
@pytest.mark.parametrize(
    "section", sweep(SECTIONS, every=lambda name: name == "components", rest=0)
)
def test_each_target_is_measured(section, page, tmp_path):
    data, written = tmp_path / "results.json", tmp_path / "performance.md"
    command = [sys.executable, RUN, "--tiny", "--only", section, "--before", sys.executable]
    command += ["--data", data, "--page", written]
    succeeded(command)
    text = data.read_text(encoding="utf-8")
    assert str(ROOT) not in text
    assert os.uname().nodename not in text
    found = json.loads(text)["sections"]
    measured = {target.text for target in page.TARGETS if target.worst(found)}
    assert measured >= SECTIONS[section]
    assert written.read_text(encoding="utf-8").startswith("# What it costs")
