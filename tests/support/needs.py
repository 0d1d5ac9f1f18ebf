"""What tests need that pip does not install of the extras `ros` and `dev`, and how one gets it.

`@pytest.mark.needs("compiler", "tshark")` skips a test that lacks one of them, and `ask("tshark")`
does so in a fixture, or at the top of a module. What stands beside the checkout, in the folder
`shared` or in that of the variable JAUSML_SHARED, is asked for by `@pytest.mark.beside("golden")`,
so that `-m beside` chooses these tests. The reason of a skip is the cure.
"""

import functools
import importlib
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path

import build_studio
import emf_check
import isolation
import pytest
import type_support

from jausml.generation.native import compiler, first_program
from jausml.language.interfaces import Installation
from jausml.live.machine.programs import PROGRAMS

ROOT = Path(__file__).resolve().parents[2]
SHARED = Path(os.environ.get("JAUSML_SHARED") or ROOT.parent / "shared")
"""Captures and definitions of other implementations, which are no part of the project."""

CHROMIUM = first_program(("chromium", "chromium-browser", "google-chrome"))
INTERFACES = (
    *("geometry_msgs", "nav_msgs", "sensor_msgs", "std_msgs", "diagnostic_msgs", "shape_msgs"),
    *("stereo_msgs", "trajectory_msgs", "visualization_msgs"),
)
"""Packages of ROS that the library describes."""
AXE = build_studio.SOURCES / "node_modules" / "axe-core" / "axe.min.js"
"""What judges whether everybody can use a page."""
SYSTEM_PYTHON = Path("/usr/bin/python3")
"""The Python of the distribution, which has the bindings of GStreamer."""
FIRST_PROCESS = (
    *("unshare", "--map-root-user", "--pid", "--fork", "--kill-child", "--mount-proc"),
)
"""What makes a program the first process of a container, as far as signals go."""

_FONT = "LiberationSans-Regular.ttf"
_FONTS = (Path("/usr/share/fonts"), Path("/usr/local/share/fonts"), Path.home() / ".fonts")
_SANITIZERS = ("address,undefined", "thread")
_GSTREAMER = (
    "import gi; gi.require_version('GstRtspServer', '1.0'); from gi.repository import Gst,"
    " GstRtspServer; Gst.init(None); assert Gst.ElementFactory.find('rtspsrc')"
)
_CAPTURE = "import socket; socket.socket(socket.AF_PACKET, socket.SOCK_RAW).close()"
_CAPABILITY = "run the tests as root, or where namespaces are allowed"
"""A namespace of their own gives processes the capabilities over it."""

_ROS_CURE = "pip install --editable '.[ros]'"


def _program(package: str, *commands: str) -> Callable[[], str]:
    """What cures the lack of a program."""
    return lambda: "" if first_program(commands) else f"apt install {package}"


def _runs(*command: str | Path) -> bool:
    try:
        return subprocess.run(command, capture_output=True, check=False).returncode == 0
    except OSError:
        return False


def _modules(cure: str, *names: str) -> Callable[[], str]:
    """What cures the lack of packages of Python, whose import may fail though they are there."""

    def missing() -> str:
        try:
            for name in names:
                importlib.import_module(name)
        except ImportError as error:
            return f"{cure} ({error})"
        return ""

    return missing


def _sanitizers() -> str:
    program = compiler()
    if program is None:
        return "apt install g++"
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder, "empty.cpp")
        source.write_text("int main() {}\n", encoding="ascii")
        line = (program, source, "-o", Path(folder, "empty"))
        if all(_runs(*line, f"-fsanitize={sanitizer}") for sanitizer in _SANITIZERS):
            return ""
    return "apt install g++, or libclang-rt-dev for clang++"


def _preloaded_sanitizer() -> str:
    line = [compiler() or "g++", "-print-file-name=libasan.so"]
    if _runs(*line):
        found = subprocess.run(line, capture_output=True, text=True, check=False).stdout
        if Path(found.strip()).is_absolute():
            return ""
    return "apt install g++"


def _emf() -> str:
    packages = emf_check.lacking()
    return f"apt install --no-install-recommends {' '.join(packages)}" if packages else ""


def _interfaces() -> str:
    absent = {*INTERFACES} - {*Installation().packages()}
    return f"{_ROS_CURE} (no {', '.join(sorted(absent))})" if absent else ""


def _nft() -> str:
    if shutil.which("nft") is None:
        return "apt install nftables"
    return "" if _runs("nft", "list", "ruleset") else _CAPABILITY


def _mounts() -> str:
    with tempfile.TemporaryDirectory() as folder:
        try:
            with isolation.small_folder(Path(folder, "small"), 1 << 16):
                pass
        except OSError as error:
            return f"{_CAPABILITY} ({error})"
    return ""


def _namespaces(*command: str) -> Callable[[], str]:
    def missing() -> str:
        if shutil.which(command[0]) is None:
            return "apt install util-linux"
        return "" if _runs(*command, "true") else _CAPABILITY

    return missing


def _two_hosts() -> str:
    absent = [program for program in ("ip", "nsenter", "unshare") if shutil.which(program) is None]
    if absent:
        return "apt install iproute2 util-linux"
    return "" if _runs("unshare", "--net", "ip", "link", "set", "lo", "up") else _CAPABILITY


NEEDS: dict[str, Callable[[], str]] = {
    **{program.name: lambda each=program: "" if each.path() else each.cure for program in PROGRAMS},
    "nft": _nft,  # which works, and is not only there
    "atheris": lambda: (
        "" if find_spec("atheris") else "pip install atheris, which has wheels for some platforms"
    ),
    "bash": _program("bash", "bash"),
    "axe": lambda: "" if AXE.is_file() else "make studio",
    "capture": lambda: "" if _runs(sys.executable, "-c", _CAPTURE) else _CAPABILITY,
    "chromium": lambda: "" if CHROMIUM else "apt install chromium",
    "emf": _emf,
    "fish": _program("fish", "fish"),
    "fonts": lambda: "" if _has_font() else "apt install fonts-liberation",
    "gstreamer": lambda: (
        ""
        if _runs(SYSTEM_PYTHON, "-c", _GSTREAMER)
        else "apt install gir1.2-gst-rtsp-server-1.0 gstreamer1.0-plugins-good python3-gi"
    ),
    "interfaces": _interfaces,
    "mounts": _mounts,
    "namespaces": lambda: "" if _runs(sys.executable, "-SE", isolation.__file__) else _CAPABILITY,
    "namespaces of networks": _two_hosts,
    "namespaces of processes": _namespaces(*FIRST_PROCESS),
    "namespaces of users": _namespaces("unshare", "--user", "--map-root-user"),
    "npm": lambda: "" if build_studio.npm() and build_studio.INSTALLED.is_file() else "make studio",
    "page": lambda: "make studio" if build_studio.is_stale() else "",
    "preloaded sanitizer": _preloaded_sanitizer,
    "rclpy": _modules(_ROS_CURE, "rclpy"),
    "rosidl": _modules(_ROS_CURE, "rosidl_adapter.parser", "rosidl_generator_py"),
    "sanitizers": _sanitizers,
    "setpriv": _program("util-linux", "setpriv"),
    "setsid": _program("util-linux", "setsid"),
    "sros2": _modules("apt install ros-jazzy-sros2", "sros2.keystore"),
    "type support": type_support.lacking,
    "zsh": _program("zsh", "zsh"),
}


def _has_font() -> bool:
    return any(next(font.rglob(_FONT), None) for font in _FONTS)


@functools.cache
def missing(name: str) -> str:
    """Returns how one gets what is needed; nothing where it is there.

    Raises:
        LookupError: There is no such need.
    """
    if name not in NEEDS:
        raise LookupError(f"{name!r} is no need that tests/support/needs.py knows")
    return NEEDS[name]()


def ask(*names: str) -> None:
    """Skips the test, or the module that is imported, where one of these needs is not met.

    Raises:
        LookupError: There is no such need.
    """
    for name in names:
        if cure := missing(name):
            pytest.skip(f"needs {name}: {cure}", allow_module_level=True)


def ask_beside(path: str) -> None:
    """Skips the test where a file or folder of `SHARED` is not there."""
    if not (SHARED / path).exists():
        pytest.skip(f"needs shared/{path} beside the checkout")


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skips what is marked, before its fixtures are made."""
    for mark in item.iter_markers("beside"):
        for path in mark.args:
            ask_beside(path)
    for mark in item.iter_markers("needs"):
        ask(*mark.args)
