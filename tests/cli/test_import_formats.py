"""The importing verbs report in every format of reports on models."""

import pytest

from jausml.language.validation.formats import RENDERERS


@pytest.mark.parametrize("output_format", RENDERERS)
def test_findings_are_rendered(jausml, tmp_path, output_format):
    definition = tmp_path / "winch_msgs" / "msg" / "Cable.msg"
    definition.parent.mkdir(parents=True)
    definition.write_text("float64 length\nnonsense\n", encoding="utf-8")
    folder, output = definition.parents[1], tmp_path / "out.xmi"
    result = jausml("import", "ros", folder, "-o", output, "--format", output_format)
    assert result.exit_code == 1
    assert "Cable.msg" in result.stdout
