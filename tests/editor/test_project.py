"""What stands in other files of the project is offered with the import that it needs."""

from jausml.authoring.editor.completion import complete
from jausml.language.metamodel.classes import ros

PACKAGE = """\
<?xml version="1.0" encoding="UTF-8"?>
<ros:InterfacePackage xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"\
 xmlns:ros="http://www.jausml.org/ros/1.0" name="abyss_msgs">
  <messages name="Tank"/>
</ros:InterfacePackage>
"""
MAP = "tanks {\n    JAUS ReportStatus\n    ROS abyss_msgs/¦\n}\n"


def offered(bench, path, place):
    return {completion.label: completion for completion in complete(bench, path, place).completions}


def test_types_of_other_files_bring_their_import(bench, at, tmp_path):
    (tmp_path / ".project").write_text("", encoding="utf-8")
    (tmp_path / "models").mkdir()
    (tmp_path / "models" / "abyss.xmi").write_text(PACKAGE, encoding="utf-8")
    path, place = at(MAP)
    bench.findings(path)
    assert offered(bench, path, place)["abyss_msgs/Tank"].module == '"models/abyss.xmi"'
    assert offered(bench, path, place)["nav_msgs/Odometry"].module == ""
    path, place = at(f'import "models/abyss.xmi"\n{MAP}')
    bench.findings(path)
    assert offered(bench, path, place)["abyss_msgs/Tank"].module == ""
    [found] = [e for e in bench.elements(path, ros.MessageType) if e.name == "Tank"]
    assert bench.place_of(path, found)[0] == tmp_path / "models" / "abyss.xmi"


def test_what_an_editor_holds_of_other_files_counts(bench, at, tmp_path):
    (tmp_path / ".project").write_text("", encoding="utf-8")
    other = tmp_path / "abyss.xmi"
    other.write_text(PACKAGE, encoding="utf-8")
    path, place = at(MAP)
    bench.texts[other] = PACKAGE.replace('"Tank"', '"Ballast"')
    bench.findings(path)
    assert "abyss_msgs/Ballast" in offered(bench, path, place)
    assert "abyss_msgs/Tank" not in offered(bench, path, place)


def test_outside_of_a_project_other_files_are_not_read(bench, at, tmp_path):
    (tmp_path / "abyss.xmi").write_text(PACKAGE, encoding="utf-8")
    path, place = at(MAP)
    bench.findings(path)
    assert "abyss_msgs/Tank" not in offered(bench, path, place)
