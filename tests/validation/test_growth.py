"""What validation costs as a model grows: no faster than n log n, counted in calls."""

from __future__ import annotations

import sys

import pytest

from jausml.validation.engine import validate

HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<system:System xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xmlns:jaus="http://www.jausml.org/jaus/1.0" xmlns:ros="http://www.jausml.org/ros/1.0"
    xmlns:bridge="http://www.jausml.org/bridge/1.0"
    xmlns:system="http://www.jausml.org/system/1.0" name="example">
"""
NUMBER = '<fields xsi:type="ros:PrimitiveField" name="v" type="uint8"/>'
OCTET = '<fields xsi:type="jaus:FixedField" name="V{}" type="uint8"/>'
SMALL, MIDDLE, LARGE = 200, 400, 800


def connections(n):
    """A service with n reports, each with its query, map and connection."""
    messages = "".join(
        f'<inputs name="QueryA{i}" code="0x{0xD100 + i:X}"/>'
        f'<outputs xmi:id="m{i}" name="ReportA{i}" code="0x{0xE100 + i:X}">'
        f'<body xsi:type="jaus:Record" name="b">{OCTET.format("")}</body></outputs>\n'
        for i in range(n)
    )
    maps = "".join(
        f'<maps xmi:id="map{i}" name="map{i}" message="m{i}" type="n">'
        '<toRos xsi:type="bridge:FieldAssignment" target="v" source="V"/></maps>\n'
        for i in range(n)
    )
    ways = "".join(
        f'<bridgeConnections name="k{i}" map="map{i}" exchange="periodicEvent" peers="c"'
        f' rate="1.0"><topics name="t{i}"/></bridgeConnections>\n'
        for i in range(n)
    )
    return (
        f'<components name="c" xmi:id="c" address="1.1.1" provides="s"/>'
        f'<bridges name="b" address="1.1.2" uses="s">{maps}{ways}</bridges>'
        f'<interfaces name="my_msgs"><messages name="N" xmi:id="n">{NUMBER}</messages></interfaces>'
        '<serviceSets name="set" version="1.0"><services name="S" xmi:id="s"'
        f' urn="urn:example:a:S" version="1.0">{messages}</services></serviceSets>'
    )


def components(n):
    return "".join(f'<components name="c{i}" address="1.{i + 1}.1"/>\n' for i in range(n))


def fields(n):
    body = "".join(OCTET.format(i) for i in range(n))
    return (
        '<serviceSets name="set" version="1.0"><services name="S" urn="urn:example:a:S"'
        ' version="1.0"><inputs name="SetA" code="0xD100" isCommand="true">'
        f'<body xsi:type="jaus:Record" name="b">{body}</body></inputs></services></serviceSets>'
    )


def inheritance(n):
    return (
        '<serviceSets name="set" version="1.0">'
        + "".join(
            f'<services name="S{i}" xmi:id="s{i}" urn="urn:example:a:S{i}" version="1.0"'
            + (f' inherits="s{i - 1}"' if i else "")
            + "/>\n"
            for i in range(n)
        )
        + "</serviceSets>"
    )


def ros_types(n):
    return (
        '<interfaces name="my_msgs">'
        + "".join(f'<messages name="T{i}" xmi:id="t{i}">{NUMBER}</messages>\n' for i in range(n))
        + "</interfaces>"
    )


def doubling_ros_types(n):
    """Types that use each other twice, most of them too large."""
    twice = "".join(
        f'<messages name="T{i}" xmi:id="t{i}">'
        + "".join(
            f'<fields xsi:type="ros:MessageField" name="f{k}" messageType="t{i - 1}"/>'
            for k in range(2)
        )
        + "</messages>\n"
        for i in range(1, n)
    )
    return (
        f'<interfaces name="my_msgs"><messages name="T0" xmi:id="t0">{NUMBER}</messages>'
        f"{twice}</interfaces>"
    )


@pytest.mark.parametrize(
    "grown", [connections, components, fields, inheritance, ros_types, doubling_ros_types]
)
def test_the_cost_grows_no_faster_than_n_log_n(tmp_path, grown):
    small, middle, large = (_calls(tmp_path, grown(n)) for n in (SMALL, MIDDLE, LARGE))
    # From the differences what does not grow is gone; n log n doubles, and 14 to 16 % more.
    assert large - middle <= 2.3 * (middle - small), (small, middle, large)


def _calls(folder, inner):
    path = folder / "grown.xmi"
    path.write_text(f"{HEAD}{inner}</system:System>\n", "utf-8")
    validate([path])  # what is remembered of the library is remembered
    count = 0

    def note(_frame, event, _argument):
        nonlocal count
        count += event in ("call", "c_call")

    before = sys.getprofile()
    sys.setprofile(note)
    try:
        validate([path])
    finally:
        sys.setprofile(before)
    return count
