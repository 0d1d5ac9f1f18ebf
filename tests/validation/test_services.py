"""What rules ask about services: inheritance of any depth and shape."""

from counting import calls

from jausml.language.validation.engine import check_project

SERVICE = """  <services name="S{n}" urn="urn:example:S{n}" version="1.0"{inherits}>
    <inputs name="Set{n}" code="0x{code:04X}"/>
  </services>
"""


def write(path, parents, codes):
    """Writes a service set; `parents` holds the position of each parent, or None."""
    services = "".join(
        SERVICE.format(
            n=number,
            inherits="" if parent is None else f' inherits="//@services.{parent}"',
            code=code,
        )
        for number, (parent, code) in enumerate(zip(parents, codes, strict=True))
    )
    path.write_text(
        '<jaus:ServiceSet xmlns:jaus="http://www.jausml.org/jaus/1.0" name="Set" version="1.0">\n'
        f"{services}</jaus:ServiceSet>\n",
        encoding="utf-8",
    )
    return path


def found(path):
    """Returns rule and line of each finding."""
    return [(finding.rule, finding.location.line) for finding in check_project([path]).diagnostics]


def test_a_deep_line_of_inheritance_is_judged_in_one_walk(tmp_path):
    """Each service once looked through all that it inherits, and took minutes for a long line.

    It is longer than calls may be nested in Python.
    """
    depth = 1200
    parents = [None, *range(depth - 1)]
    path = write(tmp_path / "deep.xmi", parents, range(1, depth + 1))
    assert found(path) == []


def test_a_service_far_down_costs_no_more_than_its_parents(tmp_path):
    def cost(depth):
        path = write(tmp_path / "line.xmi", [None, *range(depth - 1)], range(1, depth + 1))
        return sum(calls(lambda: found(path)).values())

    cost(2)  # what is remembered of the library is remembered
    assert cost(400) < 2.3 * cost(200)


def test_a_code_is_compared_with_the_whole_line_above_and_with_no_other(tmp_path):
    #      0        1 and 2 inherit 0; 3 inherits 1
    path = write(tmp_path / "tree.xmi", [None, 0, 0, 1], [0x10, 0x20, 0x20, 0x10])
    assert found(path) == [("JML312", 12)]


def test_heirs_come_before_their_parents_in_the_file(tmp_path):
    path = write(tmp_path / "late.xmi", [1, 2, None], [0x10, 0x20, 0x10])
    assert found(path) == [("JML312", 3)]


def test_a_cycle_is_found_and_what_hangs_on_it_is_left_alone(tmp_path):
    path = write(tmp_path / "cycle.xmi", [1, 0, 1], [0x10, 0x10, 0x10])
    assert {rule for rule, _ in found(path)} == {"JML311"}


def flat_message(count):
    member = '<fields xsi:type="jaus:FixedField" name="F{}" type="uint8"/>'
    members = "".join(member.format(number) for number in range(count))
    return (
        '<jaus:ServiceSet xmlns:jaus="http://www.jausml.org/jaus/1.0" name="Set" version="1.0"'
        ' xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance">\n'
        '<services name="S" urn="urn:example:S" version="1.0">'
        '<inputs name="SetAll" code="0x0410">\n'
        f'<body xsi:type="jaus:Record" name="Body">{members}</body>'
        "</inputs></services></jaus:ServiceSet>\n"
    )


def test_a_message_of_numbers_alone_may_have_all_fields_but_its_body(tmp_path):
    """They are counted at a glance, and not resolved: the limit is the same to the field."""
    for count, expected in ((9_999, []), (10_000, [("JML360", 2)])):
        path = tmp_path / f"flat_{count}.xmi"
        path.write_text(flat_message(count), encoding="utf-8")
        assert found(path) == expected
