"""Whether this checkout can be released: version, changelog, tag, wheel, sdist, dependencies.

Builds the sdist and from it the wheel, installs the wheel in an environment of its own, once with
the newest and once with the lowest versions of its dependencies, and uses it there. All steps run;
the end says which failed. Packages come from the index that pip is set to.
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
import venv
import zipfile
from collections.abc import Callable, Iterable
from importlib import metadata
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).resolve().parent.parent
RELEASE = re.compile(r"\d+\.\d+\.\d+")
PAGES = ("jausml/authoring/studio/page/", "jausml/live/operating/page/")
EXAMPLE = "minimal/minimal.xmi"
SMOKE = (
    *("tests/metamodel/test_shipped.py", "tests/model"),
    *("tests/text/test_parsing.py", "tests/generation/test_plan.py"),
    *("tests/systems/test_terminal.py", "tests/studio/server/test_process.py"),
    *("tests/studio/server/test_security.py", "tests/recording/test_bags.py"),
)
"""Tests that stand on what is installed, and start no process of ROS."""
TEST_TOOLS = ("hypothesis", "pytest", "pytest-timeout", "pytest-xdist", "pyyaml")


class NotReleasableError(Exception):
    """A step found what must be fixed before a release."""


def run(*command: str | Path, cwd: Path = ROOT) -> str:
    """Runs a command; returns what it printed.

    Raises:
        NotReleasableError: it failed.
    """
    result = subprocess.run(
        list(map(str, command)), cwd=cwd, check=False, capture_output=True, text=True
    )
    if result.returncode:
        said = "\n".join((result.stdout + result.stderr).splitlines()[-30:])
        raise NotReleasableError(f"{' '.join(map(str, command))}\n{said}")
    return result.stdout


def check_version(version: str, changelog: str, tags: Iterable[str]) -> None:
    """Checks that a version is one, is not taken, and stands in the changelog with its day.

    Raises:
        NotReleasableError: it is not so.
    """
    if not RELEASE.fullmatch(version):
        raise NotReleasableError(f"the version {version} is not of the form 1.2.3")
    if f"v{version}" in tags:
        raise NotReleasableError(f"the tag v{version} is there: raise __version__")
    if not re.search(
        rf"^## \[{re.escape(version)}\] - \d{{4}}-\d\d-\d\d$", changelog, re.MULTILINE
    ):
        raise NotReleasableError(f"CHANGELOG.md has no heading `## [{version}] - YYYY-MM-DD`")


USED = ("diagram", "studio", "top", "record")
"""Extras whose lowest versions are tried too; those of ROS have no versions of ours."""


def lowest(requirements: Iterable[str], extras: Iterable[str] = ()) -> list[str]:
    """Constraints that hold each required distribution to the lowest version that it may have.

    Args:
        extras: Those whose requirements count too.

    Raises:
        NotReleasableError: a requirement has no lower bound.
    """
    constraints = []
    for text in requirements:
        requirement = Requirement(text)
        marker = requirement.marker
        if marker and not any(marker.evaluate({"extra": extra}) for extra in ("", *extras)):
            continue
        bounds = [
            specifier.version
            for specifier in requirement.specifier
            if specifier.operator in (">=", "==")
        ]
        if not bounds:
            raise NotReleasableError(f"{requirement} has no lower bound")
        constraints.append(f"{requirement.name}=={bounds[0]}")
    return list(dict.fromkeys(constraints))


def check_page(names: Iterable[str]) -> None:
    """Checks that a wheel has the pages of the studio and of the operator unit.

    Raises:
        NotReleasableError: it has not.
    """
    files = list(names)
    for page in PAGES:
        parts = {name.removeprefix(page) for name in files if name.startswith(page)}
        if "index.html" not in parts or not any(part.endswith(".js") for part in parts):
            raise NotReleasableError(f"the wheel has no page in {page}: {sorted(parts)}")


def build(place: Path) -> Path:
    """Builds sdist and wheel; returns the wheel."""
    run(sys.executable, "-m", "build", "--outdir", place, ROOT)
    (wheel,) = place.glob("*.whl")
    return wheel


def environment(place: Path, *packages: str | Path) -> Path:
    """Makes an environment with packages; returns its folder of programs."""
    venv.create(place, with_pip=True)
    run(place / "bin" / "python", "-m", "pip", "install", "--quiet", *packages)
    return place / "bin"


def use(programs: Path, place: Path) -> None:
    """Asks an installed jausml for its version, validates an example and generates from it."""
    place.mkdir()
    code = "import jausml, pathlib; print(pathlib.Path(jausml.__file__).parent / 'models')"
    models = Path(run(programs / "python", "-c", code, cwd=place).strip())
    run(programs / "jausml", "--version", cwd=place)
    run(programs / "jausml", "validate", models / EXAMPLE, cwd=place)
    run(programs / "jausml", "generate", models / EXAMPLE, "-o", "out", cwd=place)


class Release:
    """The steps of the check, in a folder of their own."""

    def __init__(self, place: Path) -> None:
        self._place = place
        self._wheel = Path()

    def steps(self) -> dict[str, Callable[[], None]]:
        """The steps by what they check."""
        return {
            "nothing is uncommitted": self.clean,
            "version, changelog and tag agree": self.version,
            "the page of the studio is built": self.page,
            "sdist and wheel are built, the page in them": self.built,
            "the wheel works with the newest dependencies": self.newest,
            "it works with the lowest dependencies": self.lowest,
            "pipx and uvx run it": self.runners,
        }

    def clean(self) -> None:
        """Checks that what is built is what is committed."""
        if changed := run("git", "status", "--porcelain"):
            raise NotReleasableError(changed)

    def version(self) -> None:
        """Checks the version."""
        changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
        code = "import jausml; print(jausml.__version__)"
        version = run(sys.executable, "-c", code).strip()
        check_version(version, changelog, run("git", "tag").split())

    def page(self) -> None:
        """Builds the page; its tests are not those of a release."""
        run(sys.executable, "tools/build_studio.py", "--no-check")

    def built(self) -> None:
        """Builds, and looks for the page, whose files are not committed."""
        self._wheel = build(self._place / "dist")
        with zipfile.ZipFile(self._wheel) as wheel:
            check_page(wheel.namelist())

    def newest(self) -> None:
        """Installs the wheel as a user does, and uses it."""
        use(environment(self._place / "newest", self._wheel), self._place / "newest-work")

    def lowest(self) -> None:
        """Installs the wheel with the lowest versions, uses it, and runs tests beside it."""
        constraints = self._place / "lowest.txt"
        held = lowest(metadata.requires("jausml") or (), USED)
        constraints.write_text("\n".join(held) + "\n")
        wheel = f"{self._wheel}[{','.join(USED)}]"
        programs = environment(
            self._place / "lowest", "--constraint", constraints, wheel, *TEST_TOOLS
        )
        use(programs, self._place / "lowest-work")
        # From elsewhere, so that nothing takes jausml from the checkout.
        tests = [ROOT / test for test in SMOKE]
        run(programs / "pytest", "-q", "-n", "auto", *tests, cwd=self._place / "lowest-work")

    def runners(self) -> None:
        """Installs the wheel by pipx, and runs it by uvx, as the documentation says."""
        programs = environment(self._place / "runners", "pipx", "uv")
        home = self._place / "pipx"
        pipx = ("env", f"PIPX_HOME={home}", f"PIPX_BIN_DIR={home / 'bin'}", programs / "pipx")
        run(*pipx, "install", self._wheel)
        run(home / "bin" / "jausml", "--version")
        run(programs / "uvx", "--from", self._wheel, "jausml", "--version")


def main() -> int:
    """Command line entry."""
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        for name, step in Release(Path(folder)).steps().items():
            try:
                step()
            except NotReleasableError as error:
                failed += 1
                print(f"FAILED: {name}\n{error}")
            else:
                print(f"ok: {name}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
