"""Interface packages that no wheel has, made by the generators of ROS and a compiler.

The wheels of rclpy bring the generators, the headers and the libraries of other packages; what
`colcon build` would make of a package is made here: its Python classes, an extension module, and
the two libraries that rmw_fastrtps_cpp looks for. They are kept in the folder for temporary files,
under a name that stands for the definitions, so it takes some twenty seconds once.
"""

from __future__ import annotations

import fcntl
import hashlib
import json
import os
import shutil
import stat
import subprocess
import sys
import sysconfig
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

DEFINITIONS = Path(__file__).resolve().parent / "ros_definitions"
NEEDED = (
    "action_msgs",
    "builtin_interfaces",
    "geometry_msgs",
    "nav_msgs",
    "service_msgs",
    "std_msgs",
    "unique_identifier_msgs",
)
"""Packages whose types stand in those that are made, or in every action."""
_GENERATOR, _DISPATCH = "rosidl_generator_c", "rosidl_typesupport_c"
_FASTRTPS, _INTROSPECTION = "rosidl_typesupport_fastrtps_c", "rosidl_typesupport_introspection_c"
_PARTS = (_GENERATOR, _DISPATCH, _FASTRTPS, _INTROSPECTION, "rosidl_generator_py")
_MARKS = ("PUBLIC", "IMPORT", "EXPORT")
_LIBRARIES = (
    "rosidl_runtime_c",
    _DISPATCH,
    _FASTRTPS,
    _INTROSPECTION,
    "rosidl_typesupport_fastrtps_cpp",
    "fastcdr",
    "rcutils",
)


class CannotBuildError(Exception):
    """What is needed to build is not there; the text names it."""


def built(package: str, types: tuple[str, ...]) -> Path:
    """Returns the folder for the module path that has a package, made unless it is there.

    Args:
        package: A package of tools/ros_definitions.
        types: Which of its definitions, e.g. `action/FollowWaypoints.action`.

    Raises:
        CannotBuildError: There is no compiler, or no generators.
    """
    if cure := lacking():
        raise CannotBuildError(f"type support of {package} cannot be built: {cure}")
    folder = _folder(package, types)
    require_own(folder.parent)
    with (folder.parent / f"{folder.name}.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not folder.is_dir():
            with tempfile.TemporaryDirectory(dir=folder.parent) as work:
                _build(package, types, Path(work))
                (Path(work) / "py").rename(folder)
    return folder


def require_own(folder: Path) -> None:
    """Makes a folder, or looks whether it is this user's alone: what is in it will be run.

    Raises:
        PermissionError: Somebody else made it, or may write in it.
    """
    folder.mkdir(mode=0o700, exist_ok=True)
    status = folder.lstat()
    if not stat.S_ISDIR(status.st_mode) or status.st_uid != os.getuid() or status.st_mode & 0o022:
        raise PermissionError(f"{folder} is not this user's alone: remove it")


def lacking() -> str:
    """Returns how one gets what is needed to build; nothing where all is there."""
    if shutil.which("gcc") is None or shutil.which("g++") is None:
        return "apt install g++"
    if not (Path(sys.prefix) / "include" / "rosidl_runtime_c").is_dir():
        return "pip install --editable '.[ros]'"
    if not Path(sysconfig.get_paths()["include"], "Python.h").is_file():
        return "apt install python3-dev"
    return ""


def _folder(package: str, types: tuple[str, ...]) -> Path:
    texts = [(DEFINITIONS / package / file_name).read_text("utf-8") for file_name in types]
    how = Path(__file__).read_text("utf-8")
    facts = json.dumps([sys.prefix, sys.version, types, texts, how])
    digest = hashlib.sha256(facts.encode()).hexdigest()[:16]
    return (
        Path(tempfile.gettempdir()) / f"jausml-type-support-{os.getuid()}" / f"{package}-{digest}"
    )


def _build(package: str, types: tuple[str, ...], work: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-c", _GENERATE, package, str(DEFINITIONS / package), str(work), *types],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise CannotBuildError(f"the generators of ROS failed: {done.stderr[-2000:]}")
    headers = work / "c" / package / "msg"
    headers.mkdir(exist_ok=True)
    for part in (_GENERATOR, _FASTRTPS, _INTROSPECTION):
        lines = ["#pragma once"]
        lines += [f"#define {part.upper()}_{mark}_{package}" for mark in _MARKS]
        (headers / f"{part}__visibility_control.h").write_text("\n".join(lines) + "\n")
    sources = sorted(path for path in work.rglob("*.c*") if path.suffix in {".c", ".cpp"})
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        object_files = pool.map(lambda source: _compiled(source, work), sources)
        objects = dict(zip(sources, object_files, strict=True))
    home = work / "py" / package
    main, inner = (f"lib{package}__{suffix}.so" for suffix in (_FASTRTPS, _INTROSPECTION))
    own = [f"-L{home}", f"-l:{main}"]
    extension = f"{package}_s__{_DISPATCH}{sysconfig.get_config_var('EXT_SUFFIX')}"
    _link(home / main, [objects[source] for source in sources if work / "c" in source.parents], [])
    is_inner = work / _INTROSPECTION
    _link(home / inner, [objects[source] for source in sources if is_inner in source.parents], own)
    others = (work / "dispatch", work / "py")
    rest = [
        objects[source] for source in sources if any(other in source.parents for other in others)
    ]
    _link(home / extension, rest, own)
    # Who looks for the libraries finds those that are loaded, wherever they are.
    (home / "__init__.py").write_text(
        "import ctypes, pathlib\n"
        f"for each in ({main!r}, {inner!r}):\n"
        "    ctypes.CDLL(str(pathlib.Path(__file__).parent / each), mode=ctypes.RTLD_GLOBAL)\n"
    )


def _compiled(source: Path, work: Path) -> str:
    import numpy  # noqa: PLC0415 - comes with the packages of ROS

    prefix = Path(sys.prefix) / "include"
    folders = [
        work / "c",
        work / _INTROSPECTION,
        prefix,
        *(path for path in prefix.iterdir() if path.is_dir()),
    ]
    folders += [Path(sysconfig.get_paths()["include"]), Path(numpy.get_include())]
    compiler = ["g++", "-std=c++17"] if source.suffix == ".cpp" else ["gcc", "-std=gnu11"]
    target = str(source.with_suffix(f"{source.suffix}.o"))
    options = ["-O0", "-w", "-fPIC", *(f"-I{folder}" for folder in folders)]
    _run([*compiler, *options, "-c", str(source), "-o", target])
    return target


def _link(target: Path, objects: list[str], own: list[str]) -> None:
    folder = Path(sys.prefix) / "lib"
    names = [f"{package}__{part}" for package in NEEDED for part in _PARTS]
    names = [name for name in names if (folder / f"lib{name}.so").is_file()]
    libraries = [f"-l{name}" for name in (*names, *_LIBRARIES)]
    options = ["-shared", f"-Wl,-soname,{target.name}", "-o", str(target)]
    _run(["g++", *options, *objects, *own, f"-L{folder}", *libraries])


def _run(command: list[str]) -> None:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise CannotBuildError(f"{command[0]} failed: {done.stderr[-2000:]}")


_GENERATE = f"""
import json, pathlib, sys
import rosidl_generator_c, rosidl_generator_py, rosidl_generator_type_description
import {_DISPATCH}, {_FASTRTPS}, {_INTROSPECTION}
from rosidl_adapter import convert_to_idl

package, source, work = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])
share = pathlib.Path(sys.prefix) / "share"
names = [pathlib.Path(each).with_suffix(".idl") for each in sys.argv[4:]]
for each in sys.argv[4:]:
    (work / "idl" / each).parent.mkdir(parents=True, exist_ok=True)
    convert_to_idl(source, package, pathlib.Path(each), work / "idl")

def arguments(generator, folder, **more):
    folder.mkdir(parents=True, exist_ok=True)
    path = work / f"{{generator}}.json"
    path.write_text(json.dumps({{
        "package_name": package,
        "output_dir": str(folder),
        "template_dir": str(share / generator / "resource"),
        "idl_tuples": [f"{{work / 'idl'}}:{{each}}" for each in names],
        "ros_interface_dependencies": [],
        "target_dependencies": [],
        "type_description_tuples": [],
        **more,
    }}))
    return str(path)

paths = [f"{{each}}:{{share / each}}" for each in {NEEDED!r}]
rosidl_generator_type_description.generate_type_hash(
    arguments("rosidl_generator_type_description", work / "hash", include_paths=paths)
)
described = [f"{{each}}:{{work / 'hash' / each.with_suffix('.json')}}" for each in names]
c = work / "c" / package
rosidl_generator_c.generate_c(
    arguments("rosidl_generator_c", c, type_description_tuples=described)
)
{_FASTRTPS}.generate_typesupport_fastrtps_c(arguments("{_FASTRTPS}", c))
{_INTROSPECTION}.generate_c(arguments("{_INTROSPECTION}", work / "{_INTROSPECTION}" / package))
{_DISPATCH}.generate_c(
    arguments("{_DISPATCH}", work / "dispatch" / package), ["{_FASTRTPS}", "{_INTROSPECTION}"]
)
py = arguments("rosidl_generator_py", work / "py" / package)
rosidl_generator_py.generate_py(py, ["{_DISPATCH}"])
"""
