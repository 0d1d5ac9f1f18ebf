"""Generated deployments in tests: installed into a folder, and what systemd would run of them."""

import os
import shlex
import subprocess
from collections.abc import Mapping
from pathlib import Path


def install(host_folder: Path, image: Path) -> None:
    """Installs the files of a host into a folder, by its own script."""
    subprocess.run(
        [str(host_folder / "install.sh")],
        env={**os.environ, "DESTDIR": str(image)},
        check=True,
        capture_output=True,
        timeout=60,
    )


def moved(text: str, image: Path) -> str:
    """Returns a text with the absolute paths of installed files as they are in the folder."""
    for folder in ("/etc/jaus", "/usr/local/lib/jaus"):
        text = text.replace(folder, f"{image}{folder}")
    return text


def read_unit(text: str) -> dict[str, list[str]]:
    """Returns the settings of a unit, whose names differ between its sections."""
    found: dict[str, list[str]] = {}
    for line in text.splitlines():
        name, mark, value = line.partition("=")
        if mark and not line.startswith("#"):
            found.setdefault(name, []).append(value)
    return found


def read_environment(text: str) -> dict[str, str]:
    """Returns the variables of an environment file."""
    lines = (line for line in text.splitlines() if line and not line.startswith("#"))
    return {name: value for name, _, value in (line.partition("=") for line in lines)}


def started(image: Path, unit: str) -> tuple[list[str], Mapping[str, str]]:
    """Returns the command line and the environment that systemd gives an installed unit."""
    path = image / "etc" / "systemd" / "system" / unit
    settings = read_unit(moved(path.read_text(encoding="utf-8"), image))
    environment: dict[str, str] = {}
    for text in settings["Environment"]:
        environment |= dict(word.split("=", 1) for word in text.split())
    for file in settings["EnvironmentFile"]:
        environment |= read_environment(Path(file.removeprefix("-")).read_text(encoding="utf-8"))
    (command,) = settings["ExecStart"]
    environment["ROS_LOG_DIR"] = str(image / "log")
    return shlex.split(command), environment
