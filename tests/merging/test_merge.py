"""Three-way merges by elements: what theirs did is done to ours."""

import subprocess
from pathlib import Path
from random import Random

import pytest
from click.testing import CliRunner
from merging_support import MESSAGE, NODE, PACKAGE, PLANT

from jausml.authoring.differences.finding import changes
from jausml.authoring.merging.merging import States, UnmergeableError, merged
from jausml.authoring.merging.planning import MERGE_RULES
from jausml.cli import main
from jausml.language.model import LIBRARY_URI, read_models
from jausml.language.model.library import LIBRARY_URI as NAME
from jausml.language.text.reading.parsing import parse
from jausml.language.text.writing.layout import lay_out

ROOT = Path(__file__).resolve().parents[2]
BASE = (ROOT / "models" / "catvehicle" / "catvehicle.xmi").read_text(encoding="utf-8")
BASE = BASE.replace("../library/", LIBRARY_URI)
MINIMAL = (ROOT / "models" / "minimal" / "minimal.xmi").read_text(encoding="utf-8")
MINIMAL = MINIMAL.replace("../library/", NAME)
PLAIN = MINIMAL
for identifier in ("minimal", "sensor", "sensor_bridge", "velocity_map"):
    PLAIN = PLAIN.replace(f' xmi:id="{identifier}"', "")
PLAIN = PLAIN.replace('map="velocity_map"', 'map="//@bridges.0/@maps.0"')
PLAIN = PLAIN.replace('peers="sensor"', 'peers="//@components.0"')
"""References by position, as Eclipse writes them."""
HOSTS = '  <hosts name="{}" interface="10.0.0.{}"/>\n'
END = "</system:System>"


def replaced(text, *pairs):
    for old, new in pairs:
        assert old in text, old
        text = text.replace(old, new)
    return text


@pytest.fixture
def merge(tmp_path):
    """Merges three texts of model.xmi; returns the text and the findings."""

    def run(base, ours, theirs):
        (tmp_path / "model.xmi").write_text(ours, encoding="utf-8")
        states = (version.encode() for version in (base, ours, theirs))
        outcome = merged("model.xmi", tmp_path.resolve(), *states)
        return outcome.data.decode(), outcome.findings

    return run


RATE = ('rate="10.0"', 'rate="25.0"')
ADDRESS = ('address="10.1.1"', 'address="10.1.9"')


def test_changes_of_different_features_of_one_element_go_together(merge):
    text, findings = merge(
        MINIMAL, replaced(MINIMAL, RATE), replaced(MINIMAL, ("Ten times a second.", "Often."))
    )
    assert findings == ()
    assert text == replaced(MINIMAL, RATE, ("Ten times a second.", "Often."))


def test_the_layout_and_comments_of_ours_stay(merge):
    ours = replaced(MINIMAL, ("  <bridges", "  <!-- ours -->\n  <bridges"), RATE)
    text, findings = merge(MINIMAL, ours, replaced(MINIMAL, ADDRESS))
    assert (text, findings) == (replaced(ours, ADDRESS), ())


def test_the_same_change_on_both_sides_is_one(merge):
    both = replaced(MINIMAL, RATE)
    assert merge(MINIMAL, both, both) == (both, ())


def test_two_values_of_one_feature_are_a_conflict_at_its_place(merge):
    ours = replaced(MINIMAL, RATE)
    text, (finding,) = merge(MINIMAL, ours, replaced(MINIMAL, ('rate="10.0"', 'rate="50.0"')))
    assert text == ours
    assert finding.rule == "JML811"
    assert finding.message == "rate of connection 'velocity' was 10: ours is 25, theirs 50"
    line = ours.splitlines()[finding.location.line - 1]
    assert line[finding.location.column - 1 :].startswith('rate="25.0"')
    assert finding.location.path == "model.xmi"


def test_elements_that_both_added_are_both_there(merge):
    ours = replaced(MINIMAL, (END, HOSTS.format("left", 1) + END))
    theirs = replaced(MINIMAL, (END, HOSTS.format("right", 2) + END))
    text, findings = merge(MINIMAL, ours, theirs)
    both = HOSTS.format("left", 1) + HOSTS.format("right", 2)
    assert (text, findings) == (replaced(MINIMAL, (END, both + END)), ())


def test_the_same_element_added_twice_is_one(merge):
    both = replaced(MINIMAL, (END, HOSTS.format("left", 1) + END))
    theirs = replaced(both, RATE)
    assert merge(MINIMAL, both, theirs) == (theirs, ())


def test_elements_of_one_name_that_differ_are_a_conflict(merge):
    ours = replaced(MINIMAL, (END, HOSTS.format("left", 1) + END))
    theirs = replaced(MINIMAL, (END, HOSTS.format("left", 2) + END))
    text, (finding,) = merge(MINIMAL, ours, theirs)
    assert text == ours
    assert "host 'left' was added on both sides, and is not the same" in finding.message
    assert finding.message.endswith("from ours to theirs: interface 10.0.0.1 -> 10.0.0.2")


COMPONENT = """  <components{} name="second" address="10.1.7" type="vehicle">
    <provides href="http://www.jausml.org/library/jaus/mobility.xmi#VelocityStateSensor"/>
  </components>
"""


def test_references_by_position_follow_what_comes_before(merge):
    ours = replaced(PLAIN, ("  <components", COMPONENT.format("") + "  <components"))
    ours = replaced(ours, ('peers="//@components.0"', 'peers="//@components.1"'))
    theirs = replaced(PLAIN, RATE)
    text, findings = merge(PLAIN, ours, theirs)
    assert (text, findings) == (replaced(ours, RATE), ())


def test_what_theirs_puts_first_shifts_the_references_of_ours(merge):
    theirs = replaced(PLAIN, ("  <components", COMPONENT.format("") + "  <components"))
    theirs = replaced(theirs, ('peers="//@components.0"', 'peers="//@components.1"'))
    text, findings = merge(PLAIN, replaced(PLAIN, RATE), theirs)
    assert (text, findings) == (replaced(theirs, RATE), ())


def test_a_new_element_keeps_its_id_and_is_referred_to_by_it(merge):
    component = COMPONENT.format(' xmi:id="second"')
    theirs = replaced(MINIMAL, ("  <bridges", component + "  <bridges"))
    theirs = replaced(theirs, ('peers="sensor"', 'peers="sensor second"'))
    text, findings = merge(MINIMAL, replaced(MINIMAL, RATE), theirs)
    assert (text, findings) == (replaced(theirs, RATE), ())


def test_new_elements_that_refer_to_each_other(merge):
    component = COMPONENT.format("")
    theirs = replaced(PLAIN, ("  <bridges", component + "  <bridges"))
    placement = '  <placements components="//@components.1" host="//@hosts.0"/>\n'
    theirs = replaced(theirs, (END, placement + END))
    host = HOSTS.format("left", 1)
    theirs = replaced(theirs, ("  <placements", host + "  <placements"))
    text, findings = merge(PLAIN, replaced(PLAIN, RATE), theirs)
    assert findings == ()
    assert_same(merge, text, replaced(theirs, RATE))


def assert_same(merge, text, expected):
    """Compares two texts as models."""
    folder = Path(merge.__closure__[0].cell_contents)
    results = []
    for name, content in (("one", text), ("other", expected)):
        (folder / name).mkdir(exist_ok=True)
        (folder / name / "model.xmi").write_text(content, encoding="utf-8")
        results.append(read_models([folder / name / "model.xmi"]))
        assert not results[-1].has_errors, results[-1].diagnostics
    one, other = (result.model for result in results)
    assert changes(one, other, [(one.root, other.root)]) == []


def test_what_theirs_removed_goes(merge):
    base = replaced(MINIMAL, (END, HOSTS.format("left", 1) + HOSTS.format("right", 2) + END))
    theirs = replaced(base, (HOSTS.format("left", 1), ""))
    text, findings = merge(base, replaced(base, RATE), theirs)
    assert (text, findings) == (replaced(theirs, RATE), ())


def test_decisions_that_each_side_made_are_no_longer_open(merge):
    one, two, three = (
        f'      <openDecisions text="{decision}"/>\n' for decision in ("a", "b", "c")
    )
    message = "      <message href"
    base = replaced(MINIMAL, (message, one + two + three + message))
    text, findings = merge(base, replaced(base, (one, "")), replaced(base, (three, "")))
    assert (text, findings) == (replaced(MINIMAL, (message, two + message)), ())


def test_what_theirs_removed_and_ours_changed_stays_and_is_told(merge):
    base = replaced(MINIMAL, (END, HOSTS.format("left", 1) + END))
    ours = replaced(base, ("10.0.0.1", "10.0.0.7"))
    text, (finding,) = merge(base, ours, MINIMAL)
    assert text == ours
    assert (finding.rule, finding.element) == ("JML812", "minimal/left")


def test_what_ours_removed_and_theirs_changed_stays_away_and_is_told(merge):
    base = replaced(MINIMAL, (END, HOSTS.format("left", 1) + END))
    theirs = replaced(base, ("10.0.0.1", "10.0.0.7"))
    text, (finding,) = merge(base, MINIMAL, theirs)
    assert text == MINIMAL
    assert finding.rule == "JML812"
    assert "host 'left' was removed by us and changed by them: interface 10" in finding.message


def test_what_theirs_removed_and_ours_refers_to_anew_stays(merge):
    base = replaced(PLAIN, ("  <bridges", COMPONENT.format("") + "  <bridges"))
    ours = replaced(base, ('peers="//@components.0"', 'peers="//@components.0 //@components.1"'))
    text, (finding,) = merge(base, ours, PLAIN)
    assert text == ours
    assert (finding.rule, finding.element) == ("JML812", "minimal/second")
    assert "Connection 'velocity' refers to it" in finding.message


def test_what_theirs_refers_to_and_ours_removed_is_told(merge):
    base = replaced(PLAIN, ("  <bridges", COMPONENT.format("") + "  <bridges"))
    theirs = replaced(base, ('peers="//@components.0"', 'peers="//@components.0 //@components.1"'))
    text, findings = merge(base, PLAIN, theirs)
    assert text == PLAIN
    assert [finding.rule for finding in findings] == ["JML813"]


def test_an_assignment_is_one_copy(merge):
    """Half of each side would be a number that nobody meant."""
    conversions = '<conversions kind="scale">\n{1}<arguments>{0}</arguments>\n{2}</conversions>'
    base = replaced(MINIMAL, ("<conversions/>", conversions.format("2.0", " " * 10, " " * 8)))
    ours = replaced(base, ("2.0", "4.0"))
    theirs = replaced(base, ('source="YawRate"', 'source="RollRate"'))
    text, (finding,) = merge(base, ours, theirs)
    assert text == ours
    assert finding.message.startswith("field assignment 'twist.angular.z' was changed on both")
    assert "ours: " in finding.message
    assert "theirs: " in finding.message
    text, findings = merge(base, replaced(base, RATE), theirs)
    assert (text, findings) == (replaced(theirs, RATE), ())


def test_lists_of_references_take_what_each_side_added(merge):
    line = '<uses href="http://www.jausml.org/library/jaus/mobility.xmi#VelocityStateSensor"/>'
    first, second = (
        line.replace("VelocityState", sensor) for sensor in ("LocalPose", "GlobalPose")
    )
    text, findings = merge(
        MINIMAL, replaced(MINIMAL, (line, line + first)), replaced(MINIMAL, (line, line + second))
    )
    assert findings == ()
    assert text.count("<uses ") == 3
    text, findings = merge(
        MINIMAL, replaced(MINIMAL, (line, line + first)), replaced(MINIMAL, (line, first + second))
    )
    assert findings == ()
    assert [text.count(reference) for reference in (line, first, second)] == [0, 1, 1]


def test_renamed_here_and_changed_there(merge):
    ours = replaced(MINIMAL, ('name="sensor_bridge"', 'name="gateway"'))
    theirs = replaced(MINIMAL, ('address="10.1.2"', 'address="10.1.8"'))
    text, findings = merge(MINIMAL, ours, theirs)
    assert (text, findings) == (replaced(ours, ('address="10.1.2"', 'address="10.1.8"')), ())


def test_an_order_that_theirs_changed(merge):
    first = '      <toRos xsi:type="bridge:ClockAssignment" target="header.stamp"/>\n'
    second = (
        '      <toRos xsi:type="bridge:ConstantAssignment" target="header.frame_id" '
        'value="base_link"/>\n'
    )
    theirs = replaced(MINIMAL, (first + second, second + first))
    text, findings = merge(MINIMAL, replaced(MINIMAL, RATE), theirs)
    assert (text, findings) == (replaced(theirs, RATE), ())


def test_an_order_that_means_nothing_is_no_conflict(merge):
    hosts = [HOSTS.format(name, n) for n, name in enumerate(("left", "middle", "right"), 1)]
    orders = ((0, 1, 2), (1, 0, 2), (0, 2, 1))
    base, ours, theirs = (
        replaced(MINIMAL, (END, "".join(hosts[n] for n in order) + END)) for order in orders
    )
    assert merge(base, ours, theirs) == (ours, ())


def test_what_is_not_in_another_file_yet_can_be_referred_to(merge, tmp_path):
    """git has not merged the other file when it asks for this one."""
    one = '<maps xmi:id="{0}" name="{0}"/>'.format
    head = MINIMAL[: MINIMAL.index("<system:")] + "<bridge:MapLibrary"
    head += MINIMAL[MINIMAL.index("<system:System") + len("<system:System") :].partition(">")[0]
    head = head.replace('"minimal"', '"maps"')
    (tmp_path / "maps.xmi").write_text(f"{head}>{one('a')}</bridge:MapLibrary>", encoding="utf-8")
    line = (
        '<bridgeConnections name="{0}"><map href="{1}.xmi#{0}"/><topics name="{0}"/>'
        "</bridgeConnections>"
    ).format
    end = "  </bridges>"
    base = replaced(MINIMAL, (end, f"{line('a', 'maps')}{end}"))
    theirs = replaced(base, (end, f"{line('b', 'maps')}{line('c', 'more')}{end}"))
    text, findings = merge(base, replaced(base, RATE), theirs)
    assert findings == ()
    assert 'rate="25.0"' in text
    for reference in ("maps.xmi#a", "maps.xmi#b", "more.xmi#c"):
        assert text.count(f'<map href="{reference}"/>') == 1


def test_places_of_metamodels_follow_a_model_that_moved(merge):
    """They are no part of the model, but without them Eclipse opens nothing."""
    name = ' xmi:id="minimal"'
    place = (
        ' xsi:schemaLocation="http://www.jausml.org/system/1.0 {}metamodels/system.ecore"'.format
    )
    base, deeper = (
        MINIMAL.replace(name, f"{place(folder)}{name}", 1) for folder in ("../", "../../")
    )
    assert merge(base, replaced(base, RATE), deeper) == (replaced(deeper, RATE), ())
    assert merge(base, deeper, replaced(base, RATE)) == (replaced(deeper, RATE), ())
    odd = base.replace("../metamodels", "elsewhere")
    assert merge(base, odd, deeper) == (odd, ())


OLD = ("  <components", "  <!-- old -->\n  <components")
NEW = ("<!-- old -->", "<!-- newer -->")
THEIRS = ("  <bridges", "  <!-- of\n theirs -->\n  <bridges")


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "iso-8859-1"])
def test_comments_of_both_sides_are_kept(tmp_path, encoding):
    base = replaced(MINIMAL, OLD, ("UTF-8", encoding), ("Ten times", "Zehnmal, häufig"))
    ours = replaced(base, ("  <bridges", "  <!-- ours, für uns -->\n  <bridges"))
    theirs = replaced(base, NEW, THEIRS, RATE, (END, f"  <!-- end -->\n{END}"))
    states = (version.encode(encoding) for version in (base, ours, theirs))
    outcome = merged("model.xmi", tmp_path.resolve(), *states)
    assert outcome.findings == ()
    text = outcome.data.decode(encoding)
    assert text == replaced(ours, NEW, THEIRS, RATE) + "<!-- end -->\n"


def test_comments_of_theirs_at_one_place_stay_in_their_order(merge):
    several = ("  <bridges", "  <!-- one -->\n  <!-- two -->\n  <bridges")
    text, findings = merge(MINIMAL, replaced(MINIMAL, RATE), replaced(MINIMAL, several))
    assert (text, findings) == (replaced(MINIMAL, several, RATE), ())


def test_a_comment_that_both_changed_is_there_twice_and_one_that_they_took_away_is_not(merge):
    base = replaced(MINIMAL, OLD, THEIRS)
    ours = replaced(base, ("<!-- old -->", "<!-- ours -->"))
    text, findings = merge(base, ours, replaced(base, NEW, THEIRS[::-1], RATE))
    both = replaced(ours, ("<!-- ours -->", "<!-- ours -->\n  <!-- newer -->"), RATE)
    assert (text, findings) == (replaced(both, THEIRS[::-1]), ())


def test_a_comment_without_a_place_is_a_conflict(merge):
    line = " ".join(MINIMAL.split())
    theirs = replaced(line, ("<bridges", "<!-- theirs --> <bridges"))
    text, (found,) = merge(line, line, theirs)
    assert text == line
    assert (found.rule, found.message) == ("JML816", "a comment of theirs is lost: theirs")


MOVED = '  <bridges xmi:id="other" name="other" address="10.1.8">\n    {}\n  </bridges>\n'


@pytest.mark.parametrize("with_id", [True, False])
@pytest.mark.parametrize("is_known", [True, False])
def test_what_they_moved_and_we_changed_is_one_conflict_and_there_once(merge, with_id, is_known):
    closing = "    </bridgeConnections>\n"
    start, end = MINIMAL.index("    <bridgeConn"), MINIMAL.index(closing) + len(closing)
    connection = MINIMAL[start:end]
    base = MINIMAL
    if with_id:
        moved = replaced(connection, ("<bridgeConnections", '<bridgeConnections xmi:id="v"'))
        base, connection = replaced(base, (connection, moved)), moved
    if is_known:
        base = replaced(base, (END, MOVED.format("") + END))
    theirs = replaced(
        base,
        (connection, ""),
        (
            MOVED.format("") if is_known else END,
            MOVED.format(connection.strip()) + ("" if is_known else END),
        ),
    )
    ours = replaced(base, RATE)
    text, (found,) = merge(base, ours, theirs)
    assert found.rule == "JML812"
    assert (
        "was moved to bridge 'other' by them and changed by us: rate 10 -> 25 Hz" in found.message
    )
    assert text.count("<bridgeConnections") == 1
    assert RATE[1] in text
    assert 'name="other"' in text
    text, findings = merge(base, base, theirs)
    assert findings == ()
    assert text.count("<bridgeConnections") == 1
    assert text.index('name="other"') < text.index("<bridgeConnections")


@pytest.mark.parametrize("is_swapped", [False, True])
@pytest.mark.parametrize("both", [False, True])
def test_references_by_position_follow_the_other_file_of_each_side(tmp_path, is_swapped, both):
    """One side puts a message before the others and uses it, the other side changes and adds."""
    alarm, depth, last = (MESSAGE.format(name) for name in ("Alarm", "Depth", "Last"))
    old, new = PACKAGE.format(alarm), PACKAGE.format(depth + alarm)
    other = PACKAGE.format(alarm + last) if both else old
    base = PLANT.format(NODE.format("a", "1.0", 0))
    adds = PLANT.format(NODE.format("a", "1.0", 1) + NODE.format("b", "1.0", 0))
    alters = PLANT.format(NODE.format("a", "5.0", 0) + NODE.format("c", "2.0", int(both)))
    plants, packages = (adds, alters), (new, other)
    if is_swapped:
        plants, packages = plants[::-1], packages[::-1]
    around = {"d_msgs.xmi": States(*(text.encode() for text in (old, *packages)))}
    (tmp_path / "d_msgs.xmi").write_text(packages[0])
    texts = (text.encode() for text in (base, *plants))
    outcome = merged("plant.xmi", tmp_path.resolve(), *texts, around)
    assert outcome.findings == ()
    package = merged("d_msgs.xmi", tmp_path.resolve(), *(e.encode() for e in (old, *packages)))
    (tmp_path / "d_msgs.xmi").write_bytes(package.data)
    (tmp_path / "plant.xmi").write_bytes(outcome.data)
    model = read_models([tmp_path / "plant.xmi"]).model
    found = {e.name: (e.frequency, e.publishers[0].type.name) for e in model.root.nodes}
    assert found == {"a": (5, "Alarm"), "b": (1, "Depth"), "c": (2, "Last" if both else "Alarm")}


def test_another_file_whose_references_would_shift_is_named(merge, tmp_path):
    head = MINIMAL[: MINIMAL.index("  <components")].replace(' xmi:id="minimal"', "")
    placement = (
        '  <placements>\n    <components href="model.xmi#//@components.0"/>\n  </placements>\n'
    )
    other = head + placement + END
    (tmp_path / "other.xmi").write_text(other)
    theirs = replaced(PLAIN, ("  <components", COMPONENT.format("") + "  <components"))
    theirs = replaced(theirs, ('peers="//@components.0"', 'peers="//@components.1"'))
    _, findings = merge(PLAIN, replaced(PLAIN, RATE), theirs)
    assert [(finding.rule, finding.location.path) for finding in findings] == [
        ("JML814", "other.xmi")
    ]
    assert (tmp_path / "other.xmi").read_text() == other


@pytest.mark.parametrize(
    ("spoilt", "where", "text"),
    [
        (0, "the base", ""),
        (1, "our side", "<a>"),
        (2, "their side", MINIMAL.replace('type="vehicle"', 'typ="vehicle"')),
        (2, "no element 'Velocity'", MINIMAL.replace('#VelocityStateSensor"', '#Velocity"')),
    ],
)
def test_a_state_that_cannot_be_read_whole_is_not_merged(merge, spoilt, where, text):
    states = [MINIMAL] * 3
    states[spoilt] = text
    with pytest.raises(UnmergeableError, match=where):
        merge(*states)


def test_half_done_work_is_merged(merge):
    topics = '>\n      <topics name="velocity"/>\n    </bridgeConnections>'
    base = replaced(MINIMAL, (topics, "/>"))
    text, findings = merge(base, replaced(base, RATE), replaced(base, ADDRESS))
    assert (text, findings) == (replaced(base, RATE, ADDRESS), ())


def test_each_way_gives_the_same_model(merge):
    """Who merges whom makes no difference but for layout and order, where nothing conflicts."""
    ours = replaced(BASE, ('address="100.1.1"', 'address="100.1.9"'))
    theirs = replaced(
        BASE, ('name="velocity_controller"', 'name="speed_keeper"'), ('rate="10.0"', 'rate="12.5"')
    )
    (one, first), (other, second) = merge(BASE, ours, theirs), merge(BASE, theirs, ours)
    assert first == second == ()
    assert_same(merge, one, other)
    assert_same(merge, one, replaced(theirs, ('address="100.1.1"', 'address="100.1.9"')))


def test_each_rule_has_a_conflict_that_a_test_shows():
    tests = "".join(path.read_text() for path in Path(__file__).parent.glob("test_*.py"))
    for rule in MERGE_RULES:
        assert rule in tests


ROVER = """\
// A rover.
import mappings.velocity_state_sensor

component vehicle { address: 100.1.1  provides: VelocityStateSensor  external: true }
bridge front {
  address: 100.1.2
  uses: VelocityStateSensor
  // what the wheels say
  connection velocity { map: velocity_state  peers: vehicle  rate: 25  topic odometry }
}
"""


@pytest.fixture
def merge_texts(tmp_path):
    """Merges three texts of ros2jaus."""

    def run(*states):
        return merged("rover.ros2jaus", tmp_path.resolve(), *(state.encode() for state in states))

    return run


def test_what_git_keeps_of_comments_this_keeps_too(merge_texts, tmp_path):
    """Comments are written, changed and taken away at random; nothing that lines keep is lost."""
    random = Random(5)
    clean = 0
    whole = ROVER + "".join(f"component c{n} {{\n  address: 100.2.{n}\n}}\n" for n in range(1, 20))

    def commented(text, who, times=2):
        lines = text.splitlines()
        for number in sorted(random.sample(range(1, len(lines) + 1), times), reverse=True):
            lines.insert(number, f"  // {who} {random.randrange(1000)}")
        return "\n".join(lines) + "\n"

    def changed(text, who):
        said = [line for line in text.splitlines() if "// base" in line]
        gone, other = random.sample(said, 2)
        text = replaced(text, (f"{gone}\n", ""), (other, f"  // {who} was {other.strip(' /')}"))
        return commented(text, who)

    for _ in range(10):
        base = commented(whole, "base", 8)
        ours = replaced(changed(base, "ours"), ("rate: 25", "rate: 50"))
        states = (base, ours, changed(base, "theirs"))
        for name, text in zip("bot", states, strict=True):
            (tmp_path / name).write_text(text)
        command = ("git", "merge-file", "-p", "o", "b", "t")
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60)
        outcome = merge_texts(*states)
        text = outcome.data.decode()
        assert outcome.findings == ()
        assert "rate: 50" in text
        if done.returncode == 0:
            clean += 1
            kept = [line.strip() for line in done.stdout.splitlines() if "//" in line]
            assert [comment for comment in kept if comment not in text] == []
    assert clean > 2


def test_two_changes_of_one_line_of_text_go_together(merge_texts):
    ours = replaced(ROVER, ("rate: 25", "rate: 50"))
    theirs = replaced(ROVER, ("topic odometry", "topic odom"))
    outcome = merge_texts(ROVER, ours, theirs)
    assert outcome.findings == ()
    both = replaced(ours, ("topic odometry", "topic odom"))
    assert outcome.data.decode() == lay_out(parse(both).document)


def test_what_theirs_uses_in_a_text_is_imported(merge_texts):
    ours = replaced(ROVER, ("rate: 25", "rate: 50"))
    pose = "  connection pose { map: local_pose  peers: vehicle  rate: 10  topic pose }\n}\n"
    service = "VelocityStateSensor, LocalPoseSensor"
    theirs = replaced(
        ROVER,
        ("provides: VelocityStateSensor", f"provides: {service}"),
        ("uses: VelocityStateSensor", f"uses: {service}"),
        ("velocity_state_sensor\n", "velocity_state_sensor\nimport mappings.local_pose_sensor\n"),
        ("topic odometry }\n}\n", f"topic odometry }}\n{pose}"),
    )
    outcome = merge_texts(ROVER, ours, theirs)
    assert outcome.findings == ()
    text = outcome.data.decode()
    for part in ("// what the wheels say", "rate: 50", "import mappings.local_pose_sensor"):
        assert part in text
    assert "connection pose {" in text


def test_a_conflict_in_a_text_has_its_place_and_comments_of_theirs_are_kept(merge_texts):
    theirs = replaced(ROVER, ("rate: 25", "rate: 30"), ("// A rover.", "// A rover.\n// Fast."))
    outcome = merge_texts(ROVER, replaced(ROVER, ("rate: 25", "rate: 50")), theirs)
    (found,) = outcome.findings
    assert (found.rule, found.location.line) == ("JML811", 9)
    assert "// A rover.\n" in outcome.data.decode()
    assert "// Fast.\n" in outcome.data.decode()


def test_a_file_beside_that_cannot_be_read_is_left_alone(merge, tmp_path, monkeypatch):
    monkeypatch.setenv("JAUSML_MAX_FILE_MIB", "1")
    (tmp_path / "other.xmi").write_bytes(bytes(2 << 20))
    assert merge(MINIMAL, MINIMAL, replaced(MINIMAL, RATE)) == (replaced(MINIMAL, RATE), ())


def test_a_link_into_another_checkout_is_merged(tmp_path, monkeypatch):
    for name in ("here", "there"):
        (tmp_path / name / ".git").mkdir(parents=True)
    for name, text in (
        ("base.xmi", MINIMAL),
        ("there/model.xmi", MINIMAL),
        ("theirs.xmi", replaced(MINIMAL, RATE)),
    ):
        (tmp_path / name).write_text(text, encoding="utf-8")
    (tmp_path / "here" / "model.xmi").symlink_to(tmp_path / "there" / "model.xmi")
    monkeypatch.chdir(tmp_path / "here")
    done = CliRunner().invoke(main, ["merge", "../base.xmi", "model.xmi", "../theirs.xmi"])
    assert (done.exit_code, done.stderr) == (0, "")
    assert done.stdout == replaced(MINIMAL, RATE)
