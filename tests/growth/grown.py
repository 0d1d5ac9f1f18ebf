"""Models that are as large as one likes in one dimension, and of which nothing else grows."""

HEAD = """<?xml version="1.0" encoding="UTF-8"?>
<system:System xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xmlns:jaus="http://www.jausml.org/jaus/1.0" xmlns:ros="http://www.jausml.org/ros/1.0"
    xmlns:bridge="http://www.jausml.org/bridge/1.0"
    xmlns:system="http://www.jausml.org/system/1.0" name="example">
"""
COMPONENT = '<components name="c" xmi:id="c" address="1.1.1" provides="s"/>'
QUERY = '<inputs name="QueryA" code="0xD100"/>'


def model(inner):
    """Returns a document of a system."""
    return f"{HEAD}{inner}</system:System>\n"


def octet(name, inner=""):
    return f'<fields xsi:type="jaus:FixedField" name="{name}" type="uint8">{inner}</fields>'


def number(name):
    return f'<fields xsi:type="ros:PrimitiveField" name="{name}" type="uint8"/>'


def record(inner):
    return f'<body xsi:type="jaus:Record" name="b">{inner}</body>'


def each(count, line):
    """Returns one line for each number."""
    return "".join(f"{line(i)}\n" for i in range(count))


def service(inner, types=""):
    return (
        f'<serviceSets name="set" version="1.0">{types}<services xmi:id="s" name="S"'
        f' urn="urn:example:a:S" version="1.0">{inner}</services></serviceSets>'
    )


def report(body, types=""):
    """Returns a component that reports one message."""
    message = f'<outputs xmi:id="m" name="ReportA" code="0xE100">{body}</outputs>'
    return COMPONENT + service(QUERY + message, types)


def reports(count):
    """Returns a service with so many reports, each with its query."""
    return service(
        each(
            count,
            lambda i: (
                f'<inputs name="QueryA{i}" code="0x{0x1000 + i:X}"/>'
                f'<outputs xmi:id="m{i}" name="ReportA{i}" code="0x{0x6000 + i:X}">'
                f"{record(octet('V'))}</outputs>"
            ),
        )
    )


def octets(count):
    """Returns so many messages of a service that report an octet, without queries."""
    return each(
        count,
        lambda i: (
            f'<outputs name="ReportA{i}" code="0x{0x6000 + i:X}">{record(octet("V"))}</outputs>'
        ),
    )


def ros(fields, types=""):
    return (
        f'<interfaces name="my_msgs">{types}'
        f'<messages name="N" xmi:id="n">{fields}</messages></interfaces>'
    )


def bridged(body, fields, assignments, types=""):
    """Returns a bridge from one report to one topic."""
    return (
        report(body)
        + ros(fields, types)
        + '<bridges name="b" address="1.1.2" uses="s"><maps xmi:id="map" name="map" message="m"'
        f' type="n">{assignments}</maps><bridgeConnections name="k" map="map" peers="c" rate="1.0"'
        ' exchange="periodicEvent"><topics name="t"/></bridgeConnections></bridges>'
    )


def assigned(target, source, inner=""):
    return (
        f'<toRos xsi:type="bridge:FieldAssignment" target="{target}" source="{source}">'
        f"{inner}</toRos>"
    )


def messages(n):
    return COMPONENT + reports(n)


def connections(n):
    maps = each(
        n,
        lambda i: (
            f'<maps xmi:id="map{i}" name="map{i}" message="m{i}" type="n">{assigned("v", "V")}'
            "</maps>"
        ),
    )
    ways = each(
        n,
        lambda i: (
            f'<bridgeConnections name="k{i}" map="map{i}" exchange="periodicEvent" peers="c"'
            f' rate="1.0"><topics name="t{i}"/></bridgeConnections>'
        ),
    )
    return (
        COMPONENT
        + f'<bridges name="b" address="1.1.2" uses="s">{maps}{ways}</bridges>'
        + ros(number("v"))
        + reports(n)
    )


def commands(n):
    """A bridge that takes commands, each by a map of its own, and answers what it has obeyed."""
    body = record(octet("V"))
    messages = each(
        n,
        lambda i: (
            f'<inputs xmi:id="m{i}" name="SetA{i}" code="0x{0x1000 + i:X}" isCommand="true"'
            f' moves="true">{body}</inputs><inputs name="QueryA{i}" code="0x{0x3000 + i:X}"/>'
            f'<outputs name="ReportA{i}" code="0x{0x6000 + i:X}">{body}</outputs>'
        ),
    )
    maps = each(
        n,
        lambda i: (
            f'<maps xmi:id="map{i}" name="map{i}" message="m{i}" type="n">{assigned("v", "V")}'
            "<stopRos/></maps>"
        ),
    )
    ways = each(
        n,
        lambda i: (
            f'<bridgeConnections name="k{i}" map="map{i}" exchange="message">'
            f'<topics name="t{i}"/></bridgeConnections>'
        ),
    )
    user = '<components name="u" address="1.1.3" uses="s" external="true"/>'
    own = f'<bridges name="b" address="1.1.2" provides="s">{maps}{ways}</bridges>'
    return user + own + ros(number("v")) + service(messages)


def service_connections(n):
    uses = each(n, lambda i: f'<connections name="k{i}" provider="c" message="m{i}" rate="1.0"/>')
    user = f'<components name="d" address="1.1.2" uses="s">{uses}</components>'
    return COMPONENT + user + reports(n)


def assignments(n):
    return bridged(
        record(each(n, lambda i: octet(f"V{i}"))),
        each(n, lambda i: number(f"v{i}")),
        each(n, lambda i: assigned(f"v{i}", f"V{i}")),
    )


def both_directions(n):
    back = each(
        n, lambda i: f'<toJaus xsi:type="bridge:FieldAssignment" target="V{i}" source="v{i}"/>'
    )
    there = assignments(n)
    end, peer = "</maps>", '<components name="e" address="1.1.3" uses="s"/>'
    reported = (
        '<bridgeConnections name="back" map="map" direction="rosToJaus"'
        ' exchange="periodicEvent"><topics name="u"/></bridgeConnections></bridges>'
    )
    there = there.replace(end, f"{back}{end}").replace("</bridges>", f"{reported}{peer}")
    return there.replace('address="1.1.2" uses="s"', 'address="1.1.2" uses="s" provides="s"')


def ros_fields(n):
    ignored = each(n, lambda i: f'<toRos xsi:type="bridge:Ignore" target="v{i}"/>')
    fields = each(n, lambda i: number(f"v{i}"))
    return bridged(record(octet("V")), number("v") + fields, assigned("v", "V") + ignored)


def ros_structures(n):
    fields = each(n, lambda i: f'<fields xsi:type="ros:MessageField" name="f{i}" messageType="u"/>')
    ignored = each(n, lambda i: f'<toRos xsi:type="bridge:Ignore" target="f{i}"/>')
    return bridged(
        record(octet("V")),
        number("v") + fields,
        assigned("v", "V") + ignored,
        f'<messages name="U" xmi:id="u">{number("w")}</messages>',
    )


def table(n):
    named = each(
        n, lambda i: f'<values xsi:type="jaus:EnumeratedValue" value="{i}" name="NAME{i}"/>'
    )
    constants = each(n, lambda i: f'<constants name="NAME{i}" type="uint16" value="{i + 1}"/>')
    entries = each(n, lambda i: f'<entries jaus="NAME{i}" ros="NAME{i}"/>')
    field = octet("V", f"<values>{named}</values>").replace("uint8", "uint16")
    looked_up = assigned("v", "V", '<conversions kind="look_up" table="tt"/>')
    return bridged(
        record(field),
        number("v").replace("uint8", "uint16") + constants,
        f'{looked_up}<tables xmi:id="tt" name="tt">{entries}</tables>',
    )


def enumerations(n):
    named = "".join(
        f'<values xsi:type="jaus:EnumeratedValue" value="{i}" name="{name}"/>'
        for i, name in enumerate(("OFF", "ON"))
    )
    return report(record(each(n, lambda i: octet(f"V{i}", f"<values>{named}</values>"))))


def records(n):
    inner = each(
        n, lambda i: f'<fields xsi:type="jaus:Record" name="R{i}">{octet(f"V{i}")}</fields>'
    )
    return report(f'<body xsi:type="jaus:Sequence" name="b">{inner}</body>')


def options(n):
    inner = each(
        n, lambda i: f'<options xsi:type="jaus:Record" name="R{i}">{octet(f"V{i}")}</options>'
    )
    return report(f'<body xsi:type="jaus:Variant" name="b" tagType="uint16">{inner}</body>')


def jaus_types(n):
    types = each(
        n, lambda i: f'<types xsi:type="jaus:FixedField" xmi:id="T{i}" name="T{i}" type="uint8"/>'
    )
    fields = each(n, lambda i: f'<fields xsi:type="jaus:TypeReference" name="F{i}" target="T{i}"/>')
    return report(record(fields), types)


def _machine(inner, events=""):
    command = '<inputs xmi:id="m" name="SetA" code="0xD100" isCommand="true"/>'
    return COMPONENT + service(f'{command}{events}<machines name="M">{inner}</machines>')


def states(n):
    return _machine(
        each(
            n,
            lambda i: (
                f'<states name="A{i}"{"" if i else _FIRST}>'
                f'<transitions message="m" target="A{(i + 1) % n}"/></states>'
            ),
        )
    )


def transitions(n):
    ways = each(n, lambda i: f'<transitions event="E{i}" target="B"/>')
    return _machine(
        f'<states name="A"{_FIRST}>{ways}</states><states name="B"/>',
        each(n, lambda i: f'<events name="E{i}"/>'),
    )


_FIRST = ' initial="true"'


def components(n):
    return each(n, lambda i: f'<components name="c{i}" address="1.{i // 200 + 1}.{i % 200 + 1}"/>')


def references(n):
    """One attribute with many references, and many services that a component provides."""
    services = each(
        n, lambda i: f'<services xmi:id="s{i}" name="S{i}" urn="urn:example:a:S{i}" version="1.0"/>'
    )
    listed = " ".join(f"s{i}" for i in range(n))
    return (
        f'<components name="c" address="1.1.1" provides="{listed}"/>'
        f'<components name="d" address="1.1.2" uses="{listed}"/>'
        f'<serviceSets name="set" version="1.0">{services}</serviceSets>'
    )


def inheritance(n):
    services = each(
        n,
        lambda i: (
            f'<services name="S{i}" xmi:id="s{i}" urn="urn:example:a:S{i}" version="1.0"'
            + (f' inherits="s{i - 1}"' if i else "")
            + f'><outputs name="ReportA{i}" code="0x{0x6000 + i:X}"/></services>'
        ),
    )
    provider = f'<components name="c" address="1.1.1" provides="s{n - 1}"/>'
    return f'{provider}<serviceSets name="set" version="1.0">{services}</serviceSets>'


def nodes(n):
    return ros(number("v")) + each(
        n,
        lambda i: (
            f'<nodes name="n{i}"><publishers name="p" topic="t{i}" type="n"/>'
            f'<subscriptions name="q" topic="t{i}" type="n"/></nodes>'
        ),
    )


def ends_of_a_topic(n):
    ends = each(
        n,
        lambda i: (
            f'<nodes name="a{i}"><publishers name="p" topic="/t" type="n">'
            '<qos reliability="best_effort"/></publishers></nodes>'
            f'<nodes name="b{i}"><subscriptions name="p" topic="/t" type="n"/></nodes>'
        ),
    )
    return ros(number("v")) + ends


def ros_types(n):
    used = '<fields xsi:type="ros:MessageField" name="f" messageType="n"/>'
    return ros(
        number("v"), each(n, lambda i: f'<messages name="T{i}" xmi:id="t{i}">{used}</messages>')
    )


def doubling_ros_types(n):
    """Types that use each other twice, most of them too large."""
    types = f'<messages name="T0" xmi:id="t0">{number("v")}</messages>' + each(
        n - 1, lambda i: f'<messages name="T{i + 1}" xmi:id="t{i + 1}">{_twice(i)}</messages>'
    )
    return ros(number("v"), types)


def _twice(i):
    return "".join(
        f'<fields xsi:type="ros:MessageField" name="f{k}" messageType="t{i}"/>' for k in range(2)
    )


def lines(n):
    return f'<components name="c" address="1.1.1" documentation="{"A few words.&#10;" * n}"/>'


def one_line(n):
    return f'<components name="c" address="1.1.1" documentation="{"A few words. " * n}"/>'
