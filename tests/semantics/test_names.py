"""Names: the same verdicts as ROS 2 and as the generators."""

import needs
import pytest
from hypothesis import given
from hypothesis import strategies as st

from jausml.language.semantics.connections.topics import namespace_fault, resolve_topic, topic_fault
from jausml.language.semantics.names import is_identifier, package_key, snake_case
from jausml_generators.python import names as generated

ROS_TEXT = st.text(alphabet="ab_/~{}1Z é", max_size=8)


@given(ROS_TEXT)
def test_legal_topics_are_legal_to_ros(name):
    needs.ask("rclpy")
    from rclpy import validate_full_topic_name, validate_topic_name

    if not topic_fault(name):
        assert validate_topic_name.validate_topic_name(name)
        full = resolve_topic(name, "/ns", "node")
        assert validate_full_topic_name.validate_full_topic_name(full)


@given(ROS_TEXT)
def test_illegal_topics_are_illegal_to_ros_or_refused_on_purpose(name):
    needs.ask("rclpy")
    from rclpy import validate_topic_name

    fault = topic_fault(name)
    if not fault:
        return
    on_purpose = ("braces", "underscores", "'~'", "own namespace", "empty part")
    if any(word in fault for word in on_purpose):
        return
    with pytest.raises(Exception, match="Invalid topic name"):
        validate_topic_name.validate_topic_name(name)


@given(ROS_TEXT)
def test_legal_namespaces_are_legal_to_ros(namespace):
    needs.ask("rclpy")
    from rclpy import validate_namespace

    if namespace and not namespace_fault(namespace):
        absolute = namespace if namespace.startswith("/") else f"/{namespace}"
        assert validate_namespace.validate_namespace(absolute)


@pytest.mark.parametrize(
    ("name", "namespace", "full"),
    [
        ("/speed", "car", "/speed"),
        ("speed", "", "/speed"),
        ("speed", "/", "/speed"),
        ("speed", "car", "/car/speed"),
        ("a/speed", "/car/left", "/car/left/a/speed"),
        ("~/speed", "", "/driver/speed"),
        ("~/speed", "car", "/car/driver/speed"),
    ],
)
def test_topics_resolve_as_in_ros(name, namespace, full):
    assert resolve_topic(name, namespace, "driver") == full
    needs.ask("rclpy")
    from rclpy import expand_topic_name

    absolute = "/" + namespace.strip("/")
    assert expand_topic_name.expand_topic_name(name, "driver", absolute) == full


def test_longest_topic():
    assert not topic_fault("a" * 255)
    assert topic_fault("a" * 256)


@given(st.from_regex(r"[A-Za-z][A-Za-z0-9_]{0,70}", fullmatch=True))
def test_packages_collide_when_generators_give_them_one_name(name):
    package = generated.package_name(name)
    assert package_key(name) in (package, package.removesuffix("_jaus"))


@given(st.text(max_size=70))
def test_snake_case_is_that_of_the_generators(name):
    ours, theirs = snake_case(name), generated.snake_case(name)
    if ours:
        assert theirs.strip("_").removeprefix("n") in (ours, ours.removeprefix("n"))
    else:
        assert theirs == "unnamed"


@given(st.text(max_size=10))
def test_identifiers_are_python_names(name):
    if is_identifier(name):
        assert name.isascii()
        assert name.isidentifier()
