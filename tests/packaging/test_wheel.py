"""The wheel works in an empty environment, without ROS, from any working directory."""

import os
import shutil
import subprocess
import sys
import tarfile
import venv
import zipfile
from importlib import metadata
from pathlib import Path
from typing import NamedTuple

import pytest
from for_each import for_each
from packaging.requirements import Requirement
from scripts import succeeded

ROOT = Path(__file__).resolve().parents[2]

pytestmark = [pytest.mark.timeout(400), pytest.mark.slow]


def run(*command: str | Path, cwd: Path) -> str:
    """Runs a command outside the checkout; returns what it printed."""
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    result = succeeded(list(map(str, command)), cwd=cwd, env=environment, timeout=300)
    return result.stdout


def needed_by(packages: Path) -> set[str]:
    """The distributions that jausml, as it is installed in a folder, needs, and those need."""
    (jausml,) = metadata.distributions(name="jausml", path=[str(packages)])
    needed: set[str] = set()
    pending = list(jausml.requires or ())
    while pending:
        requirement = Requirement(pending.pop())
        marker = requirement.marker
        if (marker and not marker.evaluate({"extra": ""})) or requirement.name in needed:
            continue
        needed.add(requirement.name)
        pending += metadata.requires(requirement.name) or ()
    return needed


def copy_distribution(name: str, target: Path) -> None:
    """Copies what this environment has of a distribution: nothing is fetched from an index."""
    for file in metadata.files(name) or ():
        if ".." not in file.parts and file.suffix != ".pyc":
            (target / file).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(file.locate(), target / file)


def tracked() -> list[str]:
    """The files of the checkout that git knows and that are there."""
    names = succeeded(["git", "ls-files", "-z"], cwd=ROOT).stdout.split("\0")
    return [name for name in names if name and (ROOT / name).exists()]


class Made(NamedTuple):
    """Where the sdist and the wheel are, the programs of an environment with it, and a folder."""

    built: Path
    installed: Path
    folder: Path


@pytest.fixture
def made(tmp_path: Path) -> Made:
    """Builds and installs the wheel."""
    folders = [tmp_path / name for name in ("built", "wheel", "work")]
    for folder in folders:
        folder.mkdir()
    built, wheel, folder = folders
    build(built)
    return Made(built, install(built, wheel), folder)


def build(work: Path) -> None:
    """Builds the sdist of the tracked files, and of it the wheel."""
    source = work / "source"
    for name in tracked():
        (source / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, source / name, follow_symlinks=False)
    run(sys.executable, "-m", "build", "--no-isolation", "--outdir", work, source, cwd=work)


def install(built: Path, work: Path) -> Path:
    """Installs the wheel alone; returns the bin folder."""
    (wheel,) = built.glob("jausml-*.whl")
    environment = work / "environment"
    venv.create(environment)
    pip = (sys.executable, "-m", "pip", "--python", environment / "bin" / "python")
    options = ("--quiet", "--no-index", "--no-deps", "--no-compile")
    run(*pip, "install", *options, wheel, cwd=work)
    (packages,) = environment.glob("lib/python*/site-packages")
    for name in needed_by(packages):
        copy_distribution(name, packages)
    return environment / "bin"


def shipped(made: Made) -> Path:
    """Returns the folder of the models that the wheel brought."""
    code = "import jausml, pathlib; print(pathlib.Path(jausml.__file__).parent / 'models')"
    return Path(run(made.installed / "python", "-c", code, cwd=made.folder).strip())


def the_sdist_has_all_that_the_checkout_has(made: Made) -> None:
    (sdist,) = made.built.glob("jausml-*.tar.gz")
    with tarfile.open(sdist) as archive:
        packed = {name.partition("/")[2] for name in archive.getnames()}
    assert set(tracked()) - packed == set()


def type_checkers_find_what_they_need(made: Made) -> None:
    (wheel,) = made.built.glob("jausml-*.whl")
    with zipfile.ZipFile(wheel) as archive:
        packed = set(archive.namelist())
    stubs = {name for name in tracked() if name.startswith("jausml/") and name.endswith(".pyi")}
    assert stubs | {"jausml/py.typed"} <= packed


def there_is_no_ros(made: Made) -> None:
    result = subprocess.run(
        [made.installed / "python", "-c", "import rclpy"], cwd=made.folder, capture_output=True
    )
    assert result.returncode != 0


EXAMPLES = ("examples/winch/winch.xmi", "examples/waypoints/waypoints.ros2jaus")
VERBS = """
import sys
from jausml.cli import main

def verb(*words):
    try:
        main(words)
    except SystemExit as end:
        assert not end.code, words

for model in sys.argv[1:]:
    out = model.rpartition("/")[2]
    verb("validate", model)
    verb("generate", model, "-o", out)
"""


def validate_and_generate(made: Made) -> None:
    """All in one process, which begins once; the command itself is run below."""
    models = [shipped(made) / example for example in EXAMPLES]
    run(made.installed / "python", "-c", VERBS, *models, cwd=made.folder)
    for model in models:
        produced = sorted(path.name for path in (made.folder / model.name).iterdir())
        assert {"jausml_runtime", f"{model.stem}_bringup"} <= set(produced)
        runtime = made.folder / model.name / "jausml_runtime" / "jausml_runtime"
        assert (runtime / "__init__.py").is_file()
    run(made.installed / "python", "-m", "compileall", "-q", "winch.xmi", cwd=made.folder)


def own_model_by_library_address(made: Made) -> None:
    """A model outside any checkout names the shipped library by its address, without a network."""
    model = made.folder / "own" / "model.xmi"
    model.parent.mkdir()
    text = (shipped(made) / "minimal" / "minimal.xmi").read_text(encoding="utf-8")
    model.write_text(
        text.replace("../library/", "http://www.jausml.org/library/"), encoding="utf-8"
    )
    run(made.installed / "jausml", "generate", model, "-o", "out", cwd=made.folder)
    assert (made.folder / "out" / "jausml_runtime").is_dir()


# One test: of several, each worker that has one of them would build and install.
HOLDING = [
    the_sdist_has_all_that_the_checkout_has,
    type_checkers_find_what_they_need,
    there_is_no_ros,
    validate_and_generate,
    own_model_by_library_address,
]


@for_each("holds", HOLDING, ids=lambda holds: holds.__name__)
def test_the_wheel(holds, made):
    holds(made)
