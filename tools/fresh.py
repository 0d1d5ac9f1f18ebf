"""Runs `make demo` and `make test` on bare systems of Debian, and tells how they went as a table.

Each system is made anew by debootstrap and has git, make and Python; HEAD of this checkout is
cloned into it. What passes there needs nothing else of the machine that it was written on. A
command runs in namespaces of its own: with them its processes and mounts go, whatever happens.
Packages come from the index that pip is set to; its settings and certificates go along.
"""

from __future__ import annotations

import argparse
import configparser
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NoReturn

from jausml.views.pages import markdown_table

ROOT = Path(__file__).resolve().parent.parent
SYSTEMS = {"bookworm": "Debian 12", "trixie": "Debian 13", "forky": "Debian forky"}
PACKAGES = ("ca-certificates", "git", "make", "mount", "python3", "python3-venv")
LIMITS = {"debootstrap": 20, "demo": 30, "test": 180}
"""Minutes that a command may take."""
COMMANDS = ("demo", "test")
FOLDER = Path("/var/tmp/jausml-fresh")  # noqa: S108 - devices work there, and it outlives a start
CHECKOUT = "root/jausml"
HEAD = ("system", "Python", "command", "passed", "skipped", "failed", "minutes")

# The new root is a mount of its own, as tests want it that make namespaces. The shell stays, and
# is the parent of orphans.
ENTER = """\
set -e
mount --bind "$1" "$1"
cd "$1"
mount --rbind /dev dev
mount -t tmpfs tmpfs dev/shm
mount -t proc proc proc
mount -t sysfs sysfs sys
pivot_root . .
umount -l .
cd "$2"
shift 2
"$@"
exit $?
"""
NAMESPACES = ("unshare", "--mount", "--pid", "--fork", "--kill-child", "--propagation", "private")

SETTINGS = re.compile(
    r"PIP_\w+|SSL_CERT_FILE|REQUESTS_CA_BUNDLE|NODE_EXTRA_CA_CERTS|\w+_PROXY", re.IGNORECASE
)
PIP_FILE = Path("/etc/pip.conf")


@dataclass(frozen=True)
class Outcome:
    """How a command went.

    Attributes:
        failed: How many tests failed; 1 for a command without tests, or that did not get to them.
        reason: Why the command failed, empty where it did not.
    """

    passed: int
    skipped: tuple[str, ...]
    failed: int
    reason: str = ""


@dataclass(frozen=True)
class Run:
    """What was run where, and how it went."""

    system: str
    python: str
    command: str
    outcome: Outcome
    minutes: float

    def row(self) -> tuple[str, ...]:
        """Returns the row of the table."""
        end = self.outcome
        skipped = "; ".join(end.skipped) or "0"
        counts = (str(end.passed), skipped, str(end.failed), f"{self.minutes:.1f}")
        return (self.system, self.python, f"`{self.command}`", *counts)


class StillMountedError(Exception):
    """A folder is not removed, because something is mounted in it."""


def judged(log: str, reason: str) -> Outcome:
    """Returns how a command went that wrote a log.

    `reason`: why it failed, empty where it did not. A suite may run again what failed: the last
    word counts.
    """
    ends = re.findall(r"^=+ (.*) in [\d.]+s.* =+$", log, re.MULTILINE)
    counts = [{word: int(count) for count, word in re.findall(r"(\d+) (\w+)", end)} for end in ends]
    if not counts:
        return Outcome(int(not reason), (), int(bool(reason)), reason)
    skipped = tuple(f"{n}: {why}" for n, why in re.findall(r"^(\d+) skipped: (.*)$", log, re.M))
    failed = sum(counts[-1].get(word, 0) for word in ("failed", "error", "errors"))
    passed = sum(count.get("passed", 0) for count in counts)
    return Outcome(passed, skipped, max(failed, int(bool(reason))), reason)


def passed_on(environment: Mapping[str, str]) -> dict[str, str]:
    """Returns the settings of pip, certificates and proxies; those that name a folder stay."""
    return {
        name: value
        for name, value in environment.items()
        if SETTINGS.fullmatch(name) and not Path(value).is_dir()
    }


def named_files(settings: Mapping[str, str], pip_file: Path = PIP_FILE) -> Iterator[Path]:
    """Yields the files that settings name, the settings of pip and the files that these name."""
    values = list(settings.values())
    if pip_file.is_file():
        yield pip_file
        parser = configparser.RawConfigParser()
        parser.read(pip_file, encoding="utf-8")
        values += [value for section in parser.values() for value in section.values()]
    for path in map(Path, values):
        if path.is_absolute() and path.is_file():
            yield path


def mounted_in(folder: Path, mounts: str) -> list[str]:
    """Returns the places in a folder where something is mounted, by the text of a mountinfo."""
    places = [line.split()[4] for line in mounts.splitlines()]
    plain = [re.sub(r"\\(\d{3})", lambda match: chr(int(match[1], 8)), place) for place in places]
    return [mount for mount in plain if Path(mount).is_relative_to(folder)]


def remove(folder: Path) -> None:
    """Removes a system, if there is one.

    Raises:
        StillMountedError: something is mounted in it, which would be removed too.
    """
    if not folder.exists():
        return
    if places := mounted_in(folder, Path("/proc/self/mountinfo").read_text(encoding="utf-8")):
        raise StillMountedError(f"{folder} is not removed: {places[0]} is mounted")
    shutil.rmtree(folder)


class System:
    """A bare system in a folder of its own.

    Args:
        suite: Its name in the archive of Debian.
        folder: Where its folder is made, and its logs.
    """

    def __init__(self, suite: str, folder: Path) -> None:
        self._suite = suite
        self._logs = folder
        self.root = folder / suite
        self._settings = passed_on(os.environ)

    def runs(self, commands: Sequence[str], tests: str) -> Iterator[Run]:
        """Makes the system, and yields how the commands went in it, or that it cannot be made."""
        bootstrap_run = self._judge("debootstrap", self._debootstrap(), "", dict(os.environ))
        if bootstrap_run.outcome.reason:
            yield bootstrap_run
            return
        self._furnish()
        asked = self._entering("/", "python3", "--version")
        version = subprocess.run(
            asked, env=self._environment(), check=True, capture_output=True, text=True
        )
        python = version.stdout.split()[-1]
        for command in commands:
            words = ["make", command, *([f"TESTS={tests}"] if tests and command == "test" else ())]
            entering = self._entering(f"/{CHECKOUT}", *words)
            yield self._judge(command, entering, python, self._environment())

    def _debootstrap(self) -> list[str]:
        # What it mounts goes with the namespace. An older debootstrap knows no name of a newer
        # suite, but how all of them are made: as `sid`, from the mirror that it has by default.
        options = ("--variant=minbase", f"--include={','.join(PACKAGES)}")
        return [*NAMESPACES, "debootstrap", *options, self._suite, str(self.root), "", "sid"]

    def _furnish(self) -> None:
        """Clones the checkout, and copies what pip and names of hosts need."""
        checkout = self.root / CHECKOUT
        clone = ["git", "clone", "--quiet", "--no-hardlinks", str(ROOT), str(checkout)]
        subprocess.run(clone, check=True)
        for path in (Path("/etc/hosts"), *named_files(self._settings)):
            copy = self.root / path.relative_to("/")
            copy.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, copy)

    def _environment(self) -> dict[str, str]:
        path = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"
        return {"HOME": "/root", "LANG": "C.UTF-8", "PATH": path, **self._settings}

    def _entering(self, folder: str, *command: str) -> list[str]:
        return [*NAMESPACES, "sh", "-c", ENTER, "sh", str(self.root), folder, *command]

    def _judge(
        self, name: str, command: Sequence[str], python: str, environment: dict[str, str]
    ) -> Run:
        """Runs a command within its time, and returns how it went."""
        shown = f"make {name}" if name in COMMANDS else name
        log = self._logs / f"{self._suite}-{name}.log"
        print(f"{SYSTEMS[self._suite]}: {shown}, see {log}", flush=True)
        begin = time.monotonic()
        with log.open("wb") as output:
            reason = _reason(command, output.fileno(), environment, LIMITS[name])
        minutes = (time.monotonic() - begin) / 60
        outcome = judged(log.read_text(encoding="utf-8", errors="replace"), reason)
        return Run(SYSTEMS[self._suite], python, shown, outcome, minutes)


def _reason(
    command: Sequence[str], output: int, environment: dict[str, str], minutes: float
) -> str:
    """Runs a command, and returns why it failed, or nothing."""
    try:
        done = subprocess.run(
            command,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            check=False,
            timeout=minutes * 60,
        )
    except subprocess.TimeoutExpired:
        return f"not done within {minutes} minutes"
    return f"exit status {done.returncode}" if done.returncode else ""


def why_not() -> str:
    """Returns why systems cannot be made here, or nothing."""
    if os.geteuid() != 0:
        return "make fresh needs root: sudo make fresh"
    if shutil.which("debootstrap") is None:
        return "make fresh needs debootstrap: apt install debootstrap"
    return ""


def parsed(arguments: Sequence[str]) -> argparse.Namespace:
    """Returns the arguments of the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--systems", nargs="+", choices=SYSTEMS, default=list(SYSTEMS), help="which (all)"
    )
    parser.add_argument("--only", choices=COMMANDS, help="run this command alone")
    parser.add_argument("--tests", default="", help="TESTS of `make test` (all)")
    parser.add_argument(
        "--folder", type=Path, default=FOLDER, help=f"for systems and logs ({FOLDER})"
    )
    parser.add_argument("--keep", action="store_true", help="keep the systems")
    return parser.parse_args(arguments)


def _ended(*_: object) -> NoReturn:
    sys.exit(128 + signal.SIGTERM)


def main(arguments: Sequence[str]) -> int:
    """Command line entry."""
    options = parsed(arguments)
    if reason := why_not():
        print(reason, file=sys.stderr)
        return 2
    folder = options.folder.resolve()
    systems = [System(system_name, folder) for system_name in options.systems]
    if there := [candidate.root for candidate in systems if candidate.root.exists()]:
        print(f"{there[0]} is there already: remove it, or name another --folder", file=sys.stderr)
        return 2
    folder.mkdir(parents=True, exist_ok=True)
    signal.signal(signal.SIGTERM, _ended)
    runs: list[Run] = []
    for system in systems:
        try:
            runs += system.runs([options.only] if options.only else COMMANDS, options.tests)
        except KeyboardInterrupt:
            return 128 + signal.SIGINT
        finally:
            if not options.keep:
                remove(system.root)
    print("", *markdown_table(HEAD, [run.row() for run in runs]), sep="\n")
    failed = [run for run in runs if run.outcome.reason]
    for run in failed:
        print(f"\n{run.system}, {run.command}: {run.outcome.reason}")
    return 1 if failed else 0


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except StillMountedError as error:
        sys.exit(str(error))
