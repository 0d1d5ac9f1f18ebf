"""What is wrong with JSIDL files is said with its place, all of it in one run."""

import pytest
from for_each import for_each
from jsidl_support import MARKER, constants, good, marked, record, run, service, type_set

from jausml.language.model.diagnostics import Severity

FIELD = '<fixed_field name="F" field_type="unsigned byte" field_units="one" optional="false"/>'

VECTOR = '<presence_vector field_type_unsigned="unsigned byte"/>'


def one(fields, *others, types="", references=""):
    """Imports a service with a record and checks its markers; returns the only finding."""
    (found,) = marked(service(record(fields), types, references=references), *others)
    return found


@for_each(
    ("text", "hint"),
    [
        ("⟦JML604⟧<record name='Empty' optional='false'/>", ""),
        ("<record ⟦JML603⟧nam='R' optional='false'>{f}</record>", "did you mean 'name'?"),
        (
            "<record name='R' optional='false'>⟦JML602⟧<fixd_field/>{f}</record>",
            "did you mean 'fixed_field'?",
        ),
        ("<record name='R' ⟦JML605⟧optional='maybe'>{f}</record>", ""),
        ("<declared_record name='R' ⟦JML608⟧declared_type_ref='Rac' optional='false'/>", ""),
        ("⟦JML604⟧<list name='L' optional='false'><record name='R'>{f}</record></list>", ""),
        ("⟦JML604⟧<list name='L' optional='false'>{count}</list>", ""),
        (
            "<list name='L' optional='false'>{count}<record name='R'>{f}</record>"
            "⟦JML602⟧<record name='S'>{f}</record></list>",
            "",
        ),
    ],
)
def test_containers(text, hint):
    count = '<count_field field_type_unsigned="unsigned byte"/>'
    (found,) = marked(service(text.replace("{f}", FIELD).replace("{count}", count)))
    assert hint in found.hint


@for_each(
    ("text", "said"),
    [
        (
            '<fixed_field name="F" ⟦JML605⟧field_type="unsigned bite" field_units="one"/>',
            "did you mean 'unsigned byte'?",
        ),
        ('⟦JML604⟧<fixed_field field_type="byte" field_units="one"/>', "has no 'name'"),
        ('⟦JML621⟧<fixed_field name="F" field_type="byte"/>', "'one' is assumed"),
        ('<fixed_length_string name="F" ⟦JML605⟧string_length="many"/>', "unknown constant"),
        ('<fixed_length_string name="F" ⟦JML605⟧string_length="2.5"/>', "is not an integer"),
        ('<fixed_length_string name="F" ⟦JML605⟧string_length="0"/>', "is not in 1.."),
        ('<fixed_length_string name="F" ⟦JML605⟧string_length="1,5"/>', "commas"),
        ('<fixed_length_string name="F" ⟦JML605⟧string_length="1/0"/>', "divides by zero"),
        ('<fixed_length_string name="F" ⟦JML605⟧string_length="(2"/>', "not closed"),
        (
            '<fixed_length_string name="F" ⟦JML605⟧string_length="2 2"/>',
            "where the expression should end",
        ),
        ('<fixed_length_string name="F" ⟦JML605⟧string_length="2^4"/>', "'^'"),
        ('<fixed_length_string name="F" ⟦JML605⟧string_length="9e999"/>', "out of all bounds"),
        ('<fixed_length_string name="F" ⟦JML605⟧string_length=""/>', "is empty"),
        ('⟦JML604⟧<variable_length_string name="F"/>', "has no <count_field>"),
        (
            '<variable_length_string name="F"><count_field ⟦JML605⟧field_type_unsigned="byte"/>'
            "</variable_length_string>",
            "unsigned byte",
        ),
        (
            '<variable_length_string name="F"><count_field field_type_unsigned="unsigned byte"'
            ' ⟦JML613⟧max_count="0"/></variable_length_string>',
            "always empty",
        ),
        ('⟦JML604⟧<bit_field name="F" field_type_unsigned="unsigned byte"/>', "<sub_field>"),
        ('⟦JML604⟧<variable_field name="F"/>', "<type_and_units_field>"),
        (
            '<fixed_field name="F" field_type="byte" field_units="one">⟦JML604⟧<value_set/>'
            "</fixed_field>",
            "has no value",
        ),
    ],
)
def test_fields(text, said):
    found = one(text)
    assert said in f"{found.message} {found.hint}"


def test_all_findings_of_several_files_come_in_one_run():
    first = service(
        record(
            '<fixed_field name="A" ⟦JML605⟧field_type="byt" field_units="one"/>'
            '<fixed_field name="B" ⟦JML605⟧field_type="word" field_units="one"/>'
        )
    )
    second = type_set('⟦JML604⟧<record ⟦JML603⟧titel="R">⟦JML602⟧<nothing/></record>')
    marked(first, second)


@for_each(
    ("text", "rule", "place"),
    [
        (b"", "JML003", (1, 1)),
        (b"{}", "JML004", (1, 1)),
        (b"<service_def", "JML004", (1, 1)),
        (b"<a/>", "JML601", (1, 1)),
        (b'<service xmlns="urn:jaus:jsidl:1.0"/>', "JML601", (1, 1)),
        (b'\n<!DOCTYPE a [<!ENTITY x "y">]><a>&x;</a>', "JML007", (2, 1)),
        (b"<a>" * 500, "JML008", (1, 601)),
    ],
)
def test_files_that_are_no_jsidl(text, rule, place):
    from jausml.language.importers.jsidl import Source, import_sources

    (found,) = import_sources([Source("a.xml", text)]).diagnostics
    assert (found.rule, found.location.line, found.location.column) == (rule, *place)


def test_sets_without_a_service_are_no_import():
    (found,) = run(type_set("")).diagnostics
    assert found.rule == "JML614"


class TestReferences:
    SET = '<declared_type_set_ref name="s" id="{}" version="{}"/>'
    USE = '<declared_fixed_field name="V" {}declared_type_ref="s.{}" optional="false"/>'

    def test_a_set_that_is_missing_is_one_finding(self):
        reference = self.SET.replace("id=", "⟦JML607⟧id=").format("urn:example:light:Sett", "1.0")
        use = self.USE.format("", "F") + self.USE.format("", "G").replace('"V"', '"W"')
        found = one(use, type_set(FIELD, identifier="urn:example:light:Other"), types=reference)
        assert found.hint

    def test_another_version_is_taken_with_a_warning(self):
        reference = self.SET.replace("version", "⟦JML620⟧version")
        use = self.USE.format("", "F")
        found = one(use, type_set(FIELD), types=reference.format("urn:example:light:Set", "2.0"))
        assert "1.0 was taken" in found.hint

    def test_a_version_may_have_a_star(self):
        reference = self.SET.format("urn:example:light:Set", "1.*")
        good(service(record(self.USE.format("", "F")), reference), type_set(FIELD))

    def test_a_misspelt_name_is_suggested(self):
        reference = self.SET.format("urn:example:light:Set", "1.0")
        speed = FIELD.replace('"F"', '"Speed"')
        use = self.USE.format("⟦JML608⟧", "Sped")
        found = one(use, type_set(speed), types=reference + speed.replace("Speed", "Own"))
        assert "did you mean 'Speed'?" in found.hint

    def test_a_set_of_no_such_name_is_suggested(self):
        reference = self.SET.format("urn:example:light:Set", "1.0").replace('"s"', '"speeds"')
        use = self.USE.format("⟦JML608⟧", "F").replace("s.F", "sped.F")
        found = one(use, type_set(FIELD), types=reference)
        assert "did you mean 'speeds'?" in found.hint

    def test_another_kind_is_refused(self):
        use = '<declared_bit_field name="B" ⟦JML609⟧declared_type_ref="F" optional="false"/>'
        assert "is a fixed_field" in one(use, types=FIELD).message

    def test_types_that_hold_themselves_end(self):
        cycle = (
            '<sequence name="S" optional="false">⟦JML610⟧<declared_sequence name="S"'
            ' declared_type_ref="S" optional="false"/></sequence>'
        )
        use = '<declared_sequence name="Q" declared_type_ref="S" optional="false"/>'
        marked(service(use, cycle))

    def test_references_in_a_circle_end(self):
        circle = (
            '<declared_record name="A" ⟦JML610⟧declared_type_ref="B" optional="false"/>'
            '<declared_record name="B" declared_type_ref="A" optional="false"/>'
        )
        use = '<declared_record name="R" declared_type_ref="A" optional="false"/>'
        marked(service(use, circle))

    def test_constants_in_a_circle_end(self):
        circle = constants(
            '<const_def name="A" const_type="float" const_value="B"/>'
            '<const_def name="B" const_type="float" const_value="A"/>'
        )
        reference = (
            '<declared_const_set_ref name="c" id="urn:example:light:Constants" version="1.0"/>'
        )
        use = '<fixed_length_string name="F" ⟦JML605⟧string_length="c.A"/>'
        assert "needs itself" in one(use, circle, types=reference).message

    def test_a_declaration_that_nothing_uses_is_looked_at_too(self):
        wrong = '<fixed_field name="F" ⟦JML605⟧field_type="x" field_units="one"/>'
        marked(service(types=wrong))
        marked(service(types="⟦JML626⟧" + FIELD))

    def test_two_declarations_of_one_name(self):
        use = '<declared_fixed_field name="V" declared_type_ref="F" optional="false"/>'
        found = one(use, types=FIELD + "⟦JML606⟧" + FIELD)
        assert found.related[0].message == "the first declaration"

    def test_two_services_of_one_version(self):
        second = service().replace('id="urn', '⟦JML606⟧id="urn', 1)
        marked(service(), second)


class TestSize:
    def test_declarations_that_unfold_without_bound_are_cut(self, monkeypatch):
        monkeypatch.setattr("jausml.language.importers.jsidl.building.MOST_ELEMENTS", 1000)
        levels = "".join(
            f'<sequence name="S{n}" optional="false">'
            + f'<declared_sequence name="A" declared_type_ref="S{n + 1}" optional="false"/>' * 10
            + "</sequence>"
            for n in range(8)
        )
        last = f'<sequence name="S8" optional="false">{record(FIELD)}</sequence>'
        use = '<declared_sequence name="Q" declared_type_ref="S0" optional="false"/>'
        rules = {diagnostic.rule for diagnostic in run(service(use, levels + last)).diagnostics}
        assert "JML612" in rules

    def test_declarations_that_nest_too_deeply_are_cut(self):
        levels = "".join(
            f'<sequence name="S{n}" optional="false"><declared_sequence name="A"'
            f' declared_type_ref="S{n + 1}" optional="false"/></sequence>'
            for n in range(100)
        )
        last = f'<sequence name="S100" optional="false">{record(FIELD)}</sequence>'
        use = '<declared_sequence name="Q" declared_type_ref="S0" optional="false"/>'
        rules = [diagnostic.rule for diagnostic in run(service(use, levels + last)).diagnostics]
        assert "JML612" in rules

    def test_an_expression_cannot_exhaust_memory(self):
        use = '<fixed_length_string name="F" ⟦JML605⟧string_length="{}"/>'
        one(use.format("*".join(["9e300"] * 150)))
        one(use.format("(" * 200 + "1"))
        one(use.format("1+" * 1000 + "1"))


class TestMessages:
    def test_a_code_is_hexadecimal(self):
        text = service().replace('message_id="D100"', '⟦JML605⟧message_id="G100"')
        marked(text)
        made = good(service().replace('"D100"', '"0xd1"'))
        assert made.inputs[0].code == "0x00D1"

    def test_a_version_of_a_service_has_two_parts(self):
        marked(service().replace('version="1.0">', '⟦JML605⟧version="1">', 1))

    def test_is_command_may_be_missing(self):
        text = service().replace("<message_def", "⟦JML621⟧<message_def", 1)
        marked(text.replace(' is_command="true"', ""))

    @pytest.mark.parametrize(
        ("part", "inside"), [("header", FIELD), ("footer", FIELD), ("header", VECTOR)]
    )
    def test_what_the_codec_would_not_write_is_refused(self, part, inside):
        extra = f'<{part} name="H">⟦JML613⟧{record(inside)}</{part}>'
        text = service().replace('<body name="Body">', extra + '<body name="Body">', 1)
        marked(text)

    @pytest.mark.parametrize(
        "header",
        [
            '<declared_header name="H" ⟦JML628⟧declared_type_ref="{}"/>',
            '<header name="H"><declared_record name="R" ⟦JML628⟧declared_type_ref="{}"'
            ' optional="false"/></header>',
        ],
    )
    @pytest.mark.parametrize("path", ["Head", "nowhere.Head"])
    def test_a_header_that_is_not_there_is_the_one_that_all_messages_have(self, header, path):
        text = service().replace(
            '<body name="Body">', header.format(path) + '<body name="Body">', 1
        )
        (found,) = marked(text)
        assert found.severity is Severity.WARNING
        (service_set,) = run(MARKER.sub("", text)).sets
        assert service_set.services[0].inputs[0].code == "0xD100"

    def test_a_second_container_is_refused(self):
        marked(service(record(FIELD) + "⟦JML602⟧" + record(FIELD)))

    def test_an_unknown_service_to_inherit_is_suggested(self):
        references = (
            '<references><inherits_from name="e" ⟦JML611⟧id="urn:jaus:jss:core:Event"'
            ' version="1.0"/></references>'
        )
        (found,) = marked(service(references=references))
        assert found.hint == "did you mean 'urn:jaus:jss:core:Events'?"

    def test_another_version_of_a_service_is_taken_with_a_warning(self):
        references = (
            '<references><inherits_from name="e" id="urn:jaus:jss:core:Events"'
            ' ⟦JML620⟧version="7.0"/></references>'
        )
        (found,) = marked(service(references=references))
        assert found.hint == "1.1 was taken"
