"""Workspaces generated from the models in tests/cases/ros_node, and processes that use them."""

import os
import subprocess
import sys
from pathlib import Path

from generated import model_of

from jausml.generation.rendering import render
from jausml.generation.workspace import generate
from jausml_generators.bringup.target import TARGET as BRINGUP
from jausml_generators.ros_node.target import TARGET as ROS_NODE
from jausml_generators.runtime.target import TARGET as RUNTIME

ROOT = Path(__file__).resolve().parents[2]
CASES = ROOT / "tests" / "cases" / "ros_node"
PATIENCE = 60


def write(case, out, targets=(ROS_NODE, BRINGUP, RUNTIME)):
    """Generates into a folder as the command line does; returns the plan."""
    model = model_of(CASES / f"{case}.xmi")
    return generate(model, targets, out).plan


def artifacts(case, *targets):
    rendered = render(model_of(CASES / f"{case}.xmi"), targets or (ROS_NODE, BRINGUP))
    return {artifact.path: artifact for artifact in rendered}


def ros_environment(workspace=None, **more):
    """An environment with DDS on this computer and in the domain of this process."""
    folders = [str(path) for path in sorted(workspace.iterdir())] if workspace else []
    return {
        **{key: value for key, value in os.environ.items() if not key.startswith("ROS_")},
        "PYTHONPATH": os.pathsep.join(folders),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "ROS_DOMAIN_ID": os.environ["ROS_DOMAIN_ID"],
        **more,
    }


def run(*arguments, cwd=None, **environment):
    """Runs Python; returns the finished process."""
    return subprocess.run(
        [sys.executable, *map(str, arguments)],
        cwd=cwd,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        timeout=PATIENCE,
    )
