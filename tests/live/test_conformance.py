"""The example's vehicle, generated and run as a process, passes the conformance checks."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import warm
from ports import free_port
from scripts import ran

pytestmark = [pytest.mark.slow, pytest.mark.live, pytest.mark.timeout(180)]

EXAMPLE = Path(__file__).resolve().parents[2] / "models" / "catvehicle"


@pytest.fixture
def port(tmp_path):
    """The port of a running vehicle."""
    folder = tmp_path / "car"
    shutil.copytree(EXAMPLE / "src", folder)
    jausml("generate", EXAMPLE / "catvehicle.xmi", "-o", folder)
    path = os.pathsep.join(str(path) for path in folder.iterdir() if path.is_dir())
    number = free_port()
    process = subprocess.Popen(
        [sys.executable, "-m", "vehicle.main", "--jaus-port", str(number)],
        env={**os.environ, "PYTHONPATH": path},
        stderr=subprocess.DEVNULL,
    )
    try:
        yield number
    finally:
        process.terminate()
        process.wait(30)


def jausml(*arguments):
    return ran([*warm.command(), *map(str, arguments)], timeout=120)


def test_the_vehicle_conforms(port):
    ready = jausml("ocu", "status", "100.1.1", "--port", port, "--timeout", 60)
    assert ready.returncode == 0, ready.stderr
    options = ("--port", port, "--quiet-time", 0.1, "--format", "json")
    result = jausml("conformance", "100.1.1", *options)
    report = json.loads(result.stdout)
    failed = [check for check in report["checks"] if check["verdict"] == "fail"]
    assert failed == []
    assert result.returncode == 0
    ids = {check["id"] for check in report["checks"]}
    assert "codecs.PrimitiveDriver.QueryWrenchEffort" in ids
    assert report["summary"]["pass"] > 100
