"""The build of compiled cores tells what the compiler refuses."""

import pytest

from jausml.generation.native import SOURCE, State, build, compiler, library_of


@pytest.mark.needs("compiler")
def test_the_error_is_told_and_not_where_it_is(tmp_path):
    program = compiler()
    assert program is not None
    source = tmp_path / "front" / SOURCE
    source.parent.mkdir(parents=True)
    (tmp_path / "front" / "front").mkdir()
    source.write_text("struct Front {\n    int speed() { return fast; }\n};\n", encoding="utf-8")
    (built,) = build([source], program)
    assert built.state is State.FAILED
    assert "core.cpp:2:" in built.reason
    assert "error: " in built.reason
    assert "fast" in built.reason
    assert not library_of(source).exists()
    assert [path.name for path in (tmp_path / "front").iterdir() if "core" in path.name] == ["core"]
