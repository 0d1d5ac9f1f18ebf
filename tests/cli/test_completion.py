"""Completion, tried in the shells that are there."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from terminal import at_terminal

from jausml.cli.shared.options import SHELLS

PROGRAMS = Path(sys.executable).parent
WITH_JAUSML = {"PATH": f"{PROGRAMS}{os.pathsep}{os.environ['PATH']}"}
# What is typed before the tabulator, and what the shell then has on its line.
TYPED = {
    "jausml vali": "jausml validate ",
    "jausml validate --str": "jausml validate --strict ",
    "jausml list messag": "jausml list messages ",
    "jausml validate goo": "jausml validate good.xmi",
    "jausml show message SetWrenchEff": "jausml show message SetWrenchEffort ",
}


@pytest.mark.parametrize("shell", SHELLS)
def test_the_script_is_one_of_its_shell(jausml, shell):
    result = jausml("completion", shell)
    assert result.exit_code == 0
    assert "_JAUSML_COMPLETE" in result.stdout
    if program := shutil.which(shell):
        subprocess.run([program, "-n", "/dev/stdin"], input=result.stdout, text=True, check=True)


def test_of_an_unknown_shell_the_known_ones_are_told(jausml):
    result = jausml("completion", "csh")
    assert result.exit_code == 2
    assert "'bash', 'zsh', 'fish'" in result.stderr


def program(shell: str) -> str:
    """The path of a shell; skips where it is missing."""
    found = shutil.which(shell)
    if found is None:
        pytest.skip(f"{shell} is not installed (Debian package {shell})")
    return found


def complete(command, start, folder):
    """Types what TYPED has into an interactive shell, and waits for what becomes of it."""
    with at_terminal(*command, cwd=folder, environment=WITH_JAUSML) as terminal:
        terminal.type(f"{start}\necho rea''dy\n")
        terminal.wait_for("ready\r\n")
        for typed, completed in TYPED.items():
            seen = len(terminal.shown)
            terminal.type(f"{typed}\t")
            terminal.wait_for(completed, seen)
            terminal.type("\x15")  # wipes the line


def test_bash_completes(jausml, folder):
    (folder / "script").write_text(jausml("completion", "bash").stdout, encoding="utf-8")
    bash = (program("bash"), "--norc", "--noprofile", "-i")
    # Colours and bracketed paste write between the letters of the line.
    plain = "bind 'set enable-bracketed-paste off'; PS1='$ '; source ./script"
    complete(bash, plain, folder)


def test_zsh_completes(jausml, folder):
    (folder / "script").write_text(jausml("completion", "zsh").stdout, encoding="utf-8")
    zsh = (program("zsh"), "-f", "-i")
    plain = "PS1='$ '; unsetopt zle_bracketed_paste"
    start = f"{plain}; autoload -Uz compinit; compinit -u; source ./script"
    complete(zsh, start, folder)


def test_fish_completes(jausml, folder):
    (folder / "script").write_text(jausml("completion", "fish").stdout, encoding="utf-8")
    lines = [f"complete -C '{typed}'" for typed in TYPED]
    done = subprocess.run(
        [program("fish"), "--no-config", "-c", "\n".join(["source ./script", *lines])],
        cwd=folder,
        env={**os.environ, **WITH_JAUSML},
        capture_output=True,
        text=True,
        timeout=60,
    )
    offered = {line.split("\t")[0] for line in done.stdout.splitlines()}
    assert offered >= {completed.split()[-1] for completed in TYPED.values()}, done
