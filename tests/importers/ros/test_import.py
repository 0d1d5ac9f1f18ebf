"""Packages: nested types, the library, packages imported along, names and what goes wrong."""

import pytest
from for_each import for_each

from jausml.language.importers.ros import (
    InterfaceFile,
    PackageSource,
    import_packages,
    package_sources,
    placed,
)
from jausml.language.interfaces import Installation
from jausml.language.model.xmi.writer import to_xmi


def package(name, **texts):
    """Returns a package of definitions: `Winch_msg="float64 x"`."""
    files = [
        InterfaceFile(f"{name}/{key.replace('_', '.')}", text.encode())
        for key, text in texts.items()
    ]
    return PackageSource(name, files)


def found(result):
    return [
        (diagnostic.rule, str(diagnostic.location), diagnostic.message, diagnostic.hint)
        for diagnostic in result.diagnostics
    ]


@pytest.fixture
def prefix(tmp_path, monkeypatch):
    """Installs packages in a prefix of its own."""
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "prefix"))

    def install(**packages):
        for name, definitions in packages.items():
            for key, text in definitions.items():
                stem, _, kind = key.partition("_")
                path = tmp_path / "prefix" / "share" / name / kind / f"{stem}.{kind}"
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")

    return install


def test_types_of_the_library_are_referred_to():
    text = "std_msgs/Header header\ngeometry_msgs/Twist[2] twists\nRope rope\n"
    result = import_packages([package("winch_msgs", Winch_msg=text, Rope_msg="float64 length")])
    assert result.diagnostics == []
    (root,) = result.packages
    written = to_xmi([root], placed(result, {"w.xmi": [root]}), "w.xmi")
    assert 'href="http://www.jausml.org/library/ros/geometry_msgs.xmi#Twist"' in written
    assert 'name="rope" messageType="Rope"' in written
    assert '<messages xmi:id="Rope" name="Rope">' in written


def test_comments_become_documentation_and_units_or_are_left_out():
    text = "# A winch.\n\nfloat64 speed # Of the rope [m/s].\nfloat64 load # [bananas]\n"
    sources = [package("winch_msgs", Winch_msg=text, Pull_srv="# Pulls.\n---\n# Done.\n")]
    result = import_packages(sources)
    (root,) = result.packages
    (message,), (service,) = root.messages, root.services
    assert message.documentation == "A winch."
    pairs = [(f.documentation, f.units) for f in message.fields]
    assert pairs == [("Of the rope [m/s].", "m/s"), ("[bananas]", None)]
    assert (service.documentation, service.request.documentation) == ("Pulls.", None)
    assert service.response.documentation == "Done."
    (root,) = import_packages(sources, comments=False).packages
    assert "documentation" not in to_xmi([root], result.model, "w.xmi")
    assert not root.messages[0].fields[0].units


def test_a_package_that_the_library_lacks_is_imported_along(prefix):
    prefix(
        rope_msgs={"Rope_msg": "knot_msgs/Knot[] knots"}, knot_msgs={"Knot_msg": "float64 size\n"}
    )
    sources = [package("winch_msgs", Winch_msg="rope_msgs/Rope rope\n")]
    result = import_packages(sources, installation=Installation())
    names = [imported_package.name for imported_package in result.packages]
    assert names == ["winch_msgs", "rope_msgs", "knot_msgs"]
    assert [diagnostic.rule for diagnostic in result.diagnostics] == ["JML662", "JML662"]
    assert not result.has_errors
    places = {f"{imported.name}.xmi": [imported] for imported in result.packages}
    model = placed(result, places)
    written = to_xmi(result.packages[:1], model, "winch_msgs.xmi")
    assert '<messageType href="rope_msgs.xmi#Rope"/>' in written


def test_several_packages_in_one_document_have_ids_of_their_own():
    sources = [package("a_msgs", Same_msg="b_msgs/Same x"), package("b_msgs", Same_msg="bool x")]
    result = import_packages(sources)
    written = to_xmi(result.packages, placed(result, {"w.xmi": result.packages}), "w.xmi")
    assert 'xmi:id="a_msgs.Same"' in written
    assert 'messageType="b_msgs.Same"' in written


def test_a_message_and_a_service_of_one_name():
    result = import_packages([package("a_msgs", Same_msg="bool x", Same_srv="bool y\n---\n")])
    assert result.diagnostics == []
    written = to_xmi(result.packages, placed(result, {"w.xmi": result.packages}), "w.xmi")
    assert '<messages xmi:id="Same" name="Same">' in written
    assert '<services xmi:id="services.Same" name="Same">' in written


@for_each(
    ("text", "rule", "place", "hint"),
    [
        ("Rpoe rope", "JML648", "winch_msgs/Winch.msg:1:1", "did you mean 'Rope'?"),
        ("bool a\ngeometry_msgs/Twits t", "JML648", "winch_msgs/Winch.msg:2:1", "'Twist'?"),
        ("geometri_msgs/Twist t", "JML648", "winch_msgs/Winch.msg:1:1", "'geometry_msgs'?"),
        ("zz_msgs/A a", "JML648", "winch_msgs/Winch.msg:1:1", "name the folder of zz_msgs"),
        ("Header header", "JML660", "winch_msgs/Winch.msg:1:1", "write std_msgs/Header"),
        ("Winch[] inner", "JML650", "winch_msgs/Winch.msg:1:1", ""),
    ],
)
def test_types_that_lead_nowhere(text, rule, place, hint):
    result = import_packages([package("winch_msgs", Winch_msg=text, Rope_msg="float64 x")])
    ((got_rule, got_place, _, got_hint),) = found(result)
    assert (got_rule, got_place) == (rule, place)
    assert hint in got_hint


def test_a_cycle_of_two_is_reported_once():
    result = import_packages([package("a_msgs", A_msg="B b", B_msg="A[] a", C_msg="A a")])
    assert [finding[:2] for finding in found(result)] == [("JML650", "a_msgs/A.msg:1:1")]
    assert "A -> B -> A" in found(result)[0][2]


def test_header_of_the_package_itself_is_no_shorthand():
    result = import_packages([package("a_msgs", Header_msg="bool x", A_msg="Header header")])
    assert result.diagnostics == []
    (field,) = next(m for m in result.packages[0].messages if m.name == "A").fields
    assert field.messageType.eContainer().name == "a_msgs"


@for_each(
    ("source", "rule"),
    [
        (PackageSource("Winch", [InterfaceFile("Winch/A.msg", b"bool x")]), "JML641"),
        (PackageSource("a_msgs", [InterfaceFile("a_msgs/lower.msg", b"bool x")]), "JML641"),
        (PackageSource("a_msgs", [InterfaceFile("a_msgs/A.msg", b"bool \xff")]), "JML642"),
        (
            PackageSource("a_msgs", [InterfaceFile("a_msgs/A.msg", None, "Permission denied")]),
            "JML001",
        ),
        (PackageSource("a_msgs", [InterfaceFile("a_msgs/A.msg", b"#" * 2**21)]), "JML002"),
        (
            PackageSource("a_msgs", [InterfaceFile("a/A.msg", b""), InterfaceFile("b/A.msg", b"")]),
            "JML647",
        ),
        (PackageSource("a_msgs"), "JML651"),
        (PackageSource("a_msgs", [InterfaceFile("a_msgs/msg/A.idl", b"")]), "JML652"),
    ],
)
def test_files_that_cannot_be_taken(source, rule):
    assert [diagnostic.rule for diagnostic in import_packages([source]).diagnostics] == [rule]


def test_packages_are_named_by_their_manifest_or_folder(tmp_path, monkeypatch):
    for path in ("ws/one/msg/A.msg", "ws/two/srv/B.srv", "ws/two/msg/C.msg", "ws/.git/msg/D.msg"):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text("---\n" if path.endswith("srv") else "")
    manifest = "<package><name>two_msgs</name></package>"
    (tmp_path / "ws/two/package.xml").write_text(manifest)
    (tmp_path / "ws/two/msg/E.idl").write_text("")

    def packages(*paths):
        found = package_sources([str(tmp_path / path) for path in paths])
        return {source.name: [file.name for file in source.files] for source in found}

    assert packages("ws") == {"one": ["A"], "two_msgs": ["C", "E", "B"]}
    assert packages("ws/two/msg/C.msg", "ws/two") == {"two_msgs": ["C", "E", "B"]}
    assert packages("ws/two/msg") == {"two_msgs": ["C", "E"]}
    monkeypatch.chdir(tmp_path / "ws" / "one" / "msg")
    (source,) = package_sources(["A.msg"])
    assert source.name == "one"
