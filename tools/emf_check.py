"""The real Eclipse EMF as a command: judges metamodels and models, and saves them again.

    python tools/emf_check.py [--map FROM TO]... [--dump] [--resave FILE] FILE...

Runs emf/EmfCheck.java, which is compiled into build/ when it is new. Ends as that does, and with 3
when Java or a package of EMF is absent, which is then named.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SOURCE = ROOT / "tools" / "emf" / "EmfCheck.java"
JARS = Path("/usr/share/java")
PACKAGES = {
    JARS / "eclipse-emf-common.jar": "libeclipse-emf-common-java",
    JARS / "eclipse-emf-ecore.jar": "libeclipse-emf-ecore-java",
    JARS / "eclipse-emf-ecore-xmi.jar": "libeclipse-emf-ecore-xmi-java",
}


def lacking() -> list[str]:
    """Returns the packages to install before EMF can be asked."""
    packages = [package for jar, package in PACKAGES.items() if not jar.exists()]
    return packages if shutil.which("javac") else [*packages, "default-jdk-headless"]


def missing() -> str:
    """Says what to install before EMF can be asked; nothing when all is there."""
    packages = lacking()
    if not packages:
        return ""
    return f"Eclipse's EMF is absent: apt-get install --no-install-recommends {' '.join(packages)}"


def ask(*arguments: str | Path, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Runs the checker with its arguments, for two minutes at most.

    Raises:
        RuntimeError: Java or a package is absent, or EMF could not run.
        subprocess.TimeoutExpired: EMF does not end.
    """
    if missing():
        raise RuntimeError(missing())
    path = os.pathsep.join([str(_classes()), *map(str, PACKAGES)])
    # One file needs neither a second collector nor the last optimisation.
    command = ["java", "-XX:+UseSerialGC", "-XX:TieredStopAtLevel=1", "-cp", path, "EmfCheck"]
    result = subprocess.run(
        [*command, *map(str, arguments)],
        cwd=cwd,
        check=False,
        capture_output=True,
        text=True,
        timeout=120,
    )
    if "Exception in thread" in result.stderr:
        raise RuntimeError(result.stderr)
    return result


def _classes() -> Path:
    """The folder of the compiled checker, named by its source."""
    folder = ROOT / "build" / "emf" / hashlib.sha256(SOURCE.read_bytes()).hexdigest()[:16]
    if not folder.exists():
        folder.parent.mkdir(parents=True, exist_ok=True)
        # Whole or not at all, for those who start beside us.
        with tempfile.TemporaryDirectory(dir=folder.parent) as place:
            class_folder = Path(place) / "classes"
            path = os.pathsep.join(map(str, PACKAGES))
            subprocess.run(["javac", "-cp", path, "-d", class_folder, SOURCE], check=True)
            try:
                class_folder.rename(folder)
            except OSError:
                if not folder.exists():
                    raise
    return folder


def main() -> int:
    """Command line entry."""
    try:
        result = ask(*sys.argv[1:])
    except RuntimeError as error:
        print(error, file=sys.stderr)
        return 3
    sys.stdout.write(result.stdout)
    sys.stderr.write(result.stderr)
    return result.returncode


if __name__ == "__main__":
    sys.exit(main())
