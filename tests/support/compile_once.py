"""A compiler of C++ that makes the same program of the same text only once, for all workers.

`CXX` names a script that runs this module in place of the compiler. What it has made is kept, in
this run and for later ones, under a digest of all that it depends on: the text after the
preprocessor, the options, and what the compiler defines by itself, which tells its version and its
processor. Only what was compiled without a word is kept. Who asks for what another process compiles
waits for it.

Usage: compile_once.py FOLDER COMPILER ARGUMENT...
"""

import fcntl
import hashlib
import os
import shlex
import shutil
import subprocess
import sys
import time
from pathlib import Path

_FORGOTTEN = 7 * 24 * 3600
"""Seconds after which a program is removed that nobody has asked for since."""


def use(folder: Path, compiler: str | None) -> None:
    """Has this process, and those that it starts, compile so; workers do already."""
    if compiler is None or Path(compiler).parent == folder:
        return
    folder.mkdir(parents=True, exist_ok=True)
    for path in folder.iterdir():
        if path.stat().st_mtime < time.time() - _FORGOTTEN:
            path.unlink(missing_ok=True)
    script = folder / Path(compiler).name
    new = script.with_suffix(f".{os.getpid()}")
    line = shlex.join([sys.executable, "-SE", __file__, str(folder), compiler])
    new.write_text(f'#!/bin/sh\nexec {line} "$@"\n', encoding="utf-8")
    new.chmod(0o755)
    new.replace(script)
    os.environ["CXX"] = str(script)


def main(folder: Path, compiler: str, arguments: list[str]) -> int:
    """Compiles, or gives what was compiled; returns the exit status."""
    options, sources, made = _parts(arguments)
    name = _name([compiler, *options], sources) if made else ""
    if not name:
        return subprocess.run([compiler, *arguments], check=False).returncode
    kept = folder / name
    with kept.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if kept.is_file():
            os.utime(kept)
            shutil.copy(kept, made)
            return 0
        done = subprocess.run([compiler, *arguments], stderr=subprocess.PIPE, check=False)
        sys.stderr.buffer.write(done.stderr)
        if not done.returncode and not done.stderr:
            new = folder / f"{name}.{os.getpid()}"
            shutil.copy(made, new)
            new.replace(kept)
        return done.returncode


def _parts(arguments: list[str]) -> tuple[list[str], list[str], str]:
    """Returns options, sources, and what is made; nothing where it is not made of sources alone."""
    options, sources, made = [], [], ""
    rest = iter(arguments)
    for argument in rest:
        if argument == "-o":
            made = next(rest, "")
        elif argument.startswith("-"):
            options.append(argument)
        else:
            sources.append(argument)
    plain = all(source.endswith(".cpp") for source in sources)
    alone = not any(option.startswith(("-l", "-L", "-M", "-x", "-E")) for option in options)
    return options, sources, made if sources and plain and alone else ""


def _name(line: list[str], sources: list[str]) -> str:
    """Returns the digest of a program; nothing where the preprocessor finds fault with its text."""
    found = hashlib.sha256()
    for option_list in (["-dM", "-x", "c++", os.devnull], ["-P", *sources]):
        done = subprocess.run([*line, "-E", *option_list], capture_output=True, check=False)
        if done.returncode or done.stderr:
            return ""
        found.update(done.stdout)
    # Where headers lie is no matter: their text is counted.
    found.update("\0".join(argument for argument in line if not argument.startswith("-I")).encode())
    return found.hexdigest()


if __name__ == "__main__":
    sys.exit(main(Path(sys.argv[1]), sys.argv[2], sys.argv[3:]))
