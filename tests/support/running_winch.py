"""The winch of the examples, which tells where its machine is, generated and in a process."""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from shutil import copy

from workspaces import python_path, write

from jausml.generation.target import load_targets
from jausml.language.model import read_models
from jausml.language.model.library import LIBRARY_URI

EXAMPLE = Path(__file__).parents[2] / "models" / "examples" / "winch"
ADDRESS = "120.1.1"
READY = "Receiving.Ready.Controlled.Available.Ready"
PROVIDED = '<provides href="service.xmi#Winch"/>'
TELLING = f'{PROVIDED}<provides href="{LIBRARY_URI}jaus/machine-states.xmi#MachineStates"/>'


def telling_winch(folder: Path) -> Path:
    """Writes the example into a folder, with MachineStates; returns the model."""
    for name in ("service.xmi", "winch.xmi"):
        text = (EXAMPLE / name).read_text(encoding="utf-8")
        text = text.replace("../../library/", LIBRARY_URI).replace(PROVIDED, TELLING)
        (folder / name).write_text(text, encoding="utf-8")
    return folder / "winch.xmi"


@contextmanager
def running_winch(model: Path, port: int, log: Path) -> Iterator[subprocess.Popen[bytes]]:
    """Generates the winch beside its model, and runs it."""
    workspace = model.parent / "ws"
    write(read_models([model]).model, load_targets().values(), workspace)
    for name in ("winch.py", "drum.py"):
        copy(EXAMPLE / "src" / "winch" / "winch" / name, workspace / "winch" / "winch" / name)
    command = [sys.executable, "-m", "winch.main", "--jaus-port", str(port)]
    environment = {**os.environ, "PYTHONPATH": python_path(workspace)}
    with log.open("wb") as errors:
        process = subprocess.Popen(command, stdout=errors, stderr=errors, env=environment)
        try:
            yield process
        finally:
            process.terminate()
            process.wait(timeout=20)
