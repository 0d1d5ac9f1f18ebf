"""What goes wrong often says what to do next."""

import pytest

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


def test_what_is_like_no_verb_is_no_question(jausml):
    result = jausml("qqqq")
    assert result.exit_code == 2
    assert "No such command 'qqqq'." in result.stderr
