"""Completion, tried in the shells that are there."""

import os
import subprocess

import pytest
import warm
from scripts import ran
from terminal import at_terminal

from jausml.cli.shared.options import SHELLS

# What is typed before the tabulator, and what the shell then has on its line.
TYPED = {
    "jausml vali": "jausml validate ",
    "jausml validate --str": "jausml validate --strict ",
    "jausml list messag": "jausml list messages ",
    "jausml validate goo": "jausml validate good.xmi",
    "jausml show message SetWrenchEff": "jausml show message SetWrenchEffort ",
}


def with_jausml() -> dict[str, str]:
    """Where a shell finds `jausml`."""
    return {"PATH": f"{warm.programs()}{os.pathsep}{os.environ['PATH']}"}


@pytest.mark.parametrize(
    "shell",
    [pytest.param(shell_name, marks=pytest.mark.needs(shell_name)) for shell_name in SHELLS],
)
def test_the_script_is_one_of_its_shell(jausml, shell):
    result = jausml("completion", shell)
    assert result.exit_code == 0
    assert "_JAUSML_COMPLETE" in result.stdout
    subprocess.run([shell, "-n", "/dev/stdin"], input=result.stdout, text=True, check=True)


def test_of_an_unknown_shell_the_known_ones_are_told(refused):
    refused("'bash', 'zsh', 'fish'", "completion", "csh")


# Colours and bracketed paste write between the letters of the line.
BASH = "bind 'set enable-bracketed-paste off'; PS1='$ '"
ZSH = "PS1='$ '; unsetopt zle_bracketed_paste; autoload -Uz compinit; compinit -u"


@pytest.mark.parametrize(
    ("shell", "start"),
    [
        pytest.param("bash --norc --noprofile", BASH, marks=pytest.mark.needs("bash")),
        pytest.param("zsh -f", ZSH, marks=[pytest.mark.needs("zsh"), pytest.mark.slow]),
    ],
)
def test_a_shell_completes_what_is_typed(jausml, folder, shell, start):
    """Types what TYPED has into an interactive shell, and waits for what becomes of it."""
    command = [*shell.split(), "-i"]
    (folder / "script").write_text(jausml("completion", command[0]).stdout, encoding="utf-8")
    with at_terminal(*command, cwd=folder, environment=with_jausml()) as terminal:
        terminal.type(f"{start}; source ./script\necho rea''dy\n")
        terminal.wait_for("ready\r\n")
        for typed, completed in TYPED.items():
            seen = len(terminal.shown)
            terminal.type(f"{typed}\t")
            terminal.wait_for(completed, seen)
            terminal.type("\x15")  # wipes the line


@pytest.mark.needs("fish")
@pytest.mark.slow
def test_fish_completes(jausml, folder):
    (folder / "script").write_text(jausml("completion", "fish").stdout, encoding="utf-8")
    lines = [f"complete -C '{typed}'" for typed in TYPED]
    done = ran(
        ["fish", "--no-config", "-c", "\n".join(["source ./script", *lines])],
        cwd=folder,
        env={**os.environ, **with_jausml()},
        timeout=60,
    )
    offered = {line.split("\t")[0] for line in done.stdout.splitlines()}
    assert offered >= {completed.split()[-1] for completed in TYPED.values()}, done


WINCH = """\
import `jaus.core-1.1`

service_set winch {
    service Winch {
        urn: "urn:example:winch:Winch"
        inherits: Management
        inputs: new message_def QueryWinch { code: 0xD201 }
        inputs: new message_def SetWinch {
            code: 0xD101
            isCommand: true
            record WinchRec { fixed_field Pull { type: uint16  units: "percent" } }
        }
    }
}
"""


@pytest.fixture
def offered(tmp_path):
    """What a shell in a project offers."""
    project = tmp_path / "project"
    (project / "models").mkdir(parents=True)
    (project / ".project").write_text("<projectDescription/>", encoding="utf-8")
    (project / "models" / "winch.ros2jaus").write_text(WINCH, encoding="utf-8")

    def words(line, folder=project / "models"):
        asked = {
            "COMP_WORDS": line,
            "COMP_CWORD": str(len(line.split(" ")) - 1),
            "_JAUSML_COMPLETE": "bash_complete",
        }
        environment = {**os.environ, **asked}
        done = ran(warm.command(), cwd=folder, env=environment)
        assert not done.stderr
        lines = (output_line.split(",") for output_line in done.stdout.splitlines())
        # Where nothing fits, the shell is told to look for files.
        return [name for kind, name in lines if kind == "plain"]

    words.folder = project / "models"
    return words


@pytest.mark.slow
def test_names_of_the_library_and_the_project_are_offered(offered, tmp_path):
    assert offered("jausml show message SetWi") == ["SetWinch"]
    assert offered("jausml show message SetWrenchEff") == ["SetWrenchEffort"]
    assert offered("jausml show service Win") == ["Winch"]
    assert offered("jausml show map travel_speed_r") == ["travel_speed_report"]
    assert offered("jausml explain JML30") == [f"JML30{digit}" for digit in range(1, 10)]
    assert offered("jausml ocu command 100.1.1 SetWinch Pu") == ["Pull="]
    assert offered("jausml show message SetWi", tmp_path) == []


@pytest.mark.slow
def test_a_model_with_errors_takes_nothing_from_completion(offered):
    (offered.folder / "broken.ros2jaus").write_text("service_set { service", encoding="utf-8")
    assert offered("jausml show message SetWi") == ["SetWinch"]


@pytest.mark.slow
def test_models_that_are_named_are_known(offered, tmp_path):
    model = str(offered.folder / "winch.ros2jaus")
    line = f"jausml show message --model {model} SetWi"
    assert offered(line, tmp_path) == ["SetWinch"]
    line = f"jausml show message --model {tmp_path}/none.ros2jaus SetWrenchEff"
    assert offered(line, tmp_path) == ["SetWrenchEffort"]
