"""What holds for all verbs."""

import os
import subprocess
import sys
from pathlib import Path

import click
import pytest
from scripts import succeeded
from sweeps import sweep

from jausml.cli import VERBS, main
from jausml.language.validation import engine

ROOT = Path(__file__).resolve().parents[2]


def test_help_lists_the_verbs_without_loading_them():
    code = (
        "import sys; from jausml.cli import main\n"
        "try: main(['--help'])\n"
        "except SystemExit as end: assert end.code == 0\n"
        "heavy = {'pyecore', 'jinja2', 'multigen', 'lxml'} & set(sys.modules)\n"
        "assert not heavy, heavy\n"
    )
    result = succeeded([sys.executable, "-c", code])
    for verb, (_, text) in VERBS.items():
        assert f"  {verb}" in result.stdout
        assert text in result.stdout


@pytest.mark.parametrize(
    "words",
    sweep(
        [["show", "message", "SetVelocityCommand"], ["list", "services"], ["decode", "0220"]],
        every=3,
    ),
)
def test_looking_up_messages_loads_neither_runtime_nor_text(words):
    code = (
        f"import sys; from jausml.cli import main\n"
        f"try: main({words})\n"
        "except SystemExit as end: assert not end.code\n"
        "heavy = {'jausml.runtime', 'jausml.language.text.reading', 'lark', 'jinja2',"
        " 'jausml_generators'}\n"
        "assert not heavy & set(sys.modules), heavy & set(sys.modules)\n"
    )
    succeeded([sys.executable, "-c", code])


def commands():
    """Yields all verbs, and the verbs inside them, with their paths."""
    found = [(name, main.get_command(click.Context(main), name)) for name in VERBS]
    while found:
        path, command = found.pop()
        if isinstance(command, click.Group):
            inner = command.list_commands(click.Context(command))
            found += [
                (f"{path} {name}", command.get_command(click.Context(command), name))
                for name in inner
            ]
        yield path, command


def ranges():
    """Yields the options of all verbs, and of verbs inside them, that are numbers in a range."""
    for path, command in commands():
        for option in command.params:
            if isinstance(option.type, click.FloatRange):
                yield path, option


def test_help_has_no_marks_of_its_layout():
    """A raw docstring would show what tells click to keep lines, and run them together."""
    for path, command in commands():
        assert "\\b" not in command.get_help(click.Context(command, info_name=path)), path


def test_no_number_of_an_option_is_not_a_number():
    options = list(ranges())
    assert {path for path, _ in options} >= {"top", "ocu watch", "run", "decode"}
    for _, option in options:
        for text in ("nan", "inf"):
            with pytest.raises(click.BadParameter):
                option.type.convert(text, option, None)


@pytest.mark.parametrize("verb", VERBS)
def test_each_verb_has_help_that_begins_with_its_text(jausml, verb):
    result = jausml(verb, "--help")
    assert result.exit_code == 0
    assert result.stdout.startswith(f"Usage: main {verb}")
    first_words = VERBS[verb][1].rstrip(".").split()[:2]
    assert " ".join(first_words) in result.stdout


def test_version(jausml):
    assert jausml("--version").stdout.startswith("jausml, version ")


@pytest.mark.usefixtures("here")  # which is no project
@pytest.mark.parametrize("arguments", [["nothing"], ["validate"], ["generate"], ["run"]])
def test_wrong_use_is_2(jausml, arguments):
    assert jausml(*arguments).exit_code == 2


@pytest.mark.usefixtures("folder")
def test_internal_error_is_3_and_short(jausml, monkeypatch):
    def fail(*_, **__):
        raise KeyError("inside")

    monkeypatch.setattr(engine, "check_project", fail)
    result = jausml("validate", "good.xmi")
    assert result.exit_code == 3
    assert (
        result.stderr == "jausml: internal error: KeyError: 'inside' (jausml --debug shows where)\n"
    )
    result = jausml("--debug", "validate", "good.xmi")
    assert result.exit_code == 3
    assert "Traceback" in result.stderr
    assert "in fail" in result.stderr


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize(
    "arguments",
    ["build {}", "case good.xmi -o {}", "diff HEAD:{} good.xmi", "generate good.xmi -o {}"],
)
def test_a_name_that_no_file_can_have_is_2(jausml, arguments):
    result = jausml(*arguments.format("a" * 300).split())
    assert (result.exit_code, result.stderr.count("File name too long\n")) == (2, 1)


def test_terminal_without_unicode(folder):
    (folder / "bad.xmi").write_text(
        (folder / "bad.xmi").read_text().replace('name="velocity"', 'name="vélocité"')
    )
    result = subprocess.run(
        [sys.executable, "-m", "jausml", "validate", "bad.xmi"],
        capture_output=True,
        env={**os.environ, "PYTHONIOENCODING": "ascii"},
    )
    assert result.returncode == 1
    assert b"JML501" in result.stdout
    assert b"Traceback" not in result.stderr


def test_rules_lists_every_rule(jausml):
    lines = jausml("rules").stdout.splitlines()
    assert "JML103 error   unknown feature" in lines
    assert "JML403 warning incompatible quality of service" in lines
    assert lines == sorted(lines)


def test_explain_shows_the_documentation(jausml):
    result = jausml("explain", "jml301")
    assert result.exit_code == 0
    assert result.stdout.startswith("JML301: JAUS address out of range (error)\n\nAn address is")
    assert "Bad: " in result.stdout
    assert jausml("explain", "JML103").stdout.startswith("JML103: unknown feature (error)")


def test_explain_of_an_unknown_rule(refused):
    refused("did you mean JML", "explain", "JML331")


@pytest.mark.parametrize(("arguments", "collects"), [("--version", False), ("ocu --help", True)])
def test_a_short_process_collects_no_garbage(arguments, collects):
    """Models are cycles of objects; to look for garbage among them takes as long as the work."""
    code = (
        "import gc, sys\nfrom jausml import cli\ntry:\n    cli.program()\n"
        "finally:\n    print('collects', gc.isenabled())"
    )
    done = succeeded([sys.executable, "-c", code, *arguments.split()])
    assert f"collects {collects}" in done.stdout


# -- what to do next -------------------------------------------------------------------------------


NEXT = {
    "valdate good.xmi": "did you mean validate?",
    "validate god.xmi": "did you mean good.xmi?",
    "validate nothing": "'jausml init DIR' makes a project of models",
    "generate .": "name one model file, such as bad.xmi",
    "report .": "name one model file, such as bad.xmi",
    "run nothing": "'jausml generate MODEL -o nothing' makes one",
    "generate good.xmi --target ros": "installed: bridge, ",
    "show message SetWrench": "did you mean SetWrenchEffort?",
    "show ReportVelocityState": "is a message: jausml show message ReportVelocityState",
    "show VelocityStateSensor": "is a service: jausml show service VelocityStateSensor",
    "show velocity_state": "is a map: jausml show map velocity_state",
    "show map velocity": "did you mean velocity_command or velocity_command_report or",
    "show map qqq": "`jausml list maps` lists them",
    "explain JML9": "'jausml rules' lists them",
    "ocu status 100.1": "expected e.g. 100.1.2",
    "ocu status 100.1.1 --interface 192.0.2.1": "'jausml doctor --interface 192.0.2.1' tells more",
    "diagram good.xmi --view map:x -o x.svg": "there are: ",
    "generate good.xmi -o good.xmi": "is no folder",
}


@pytest.mark.parametrize("command", NEXT)
def test_an_error_says_what_to_do_next(jausml, folder, command):
    (folder / "nothing").mkdir()
    result = jausml(*command.split())
    assert result.exit_code == 2
    assert NEXT[command] in result.stderr
    assert "Traceback" not in result.stderr


def test_what_is_like_no_verb_is_no_question(refused):
    refused("No such command 'qqqq'.", "qqqq")
