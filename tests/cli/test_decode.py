"""`jausml decode` and `jausml encode`."""

import json
import os
import signal
import socket
import struct
import subprocess

import pytest
import warm
from ports import free_port
from terminal import at_terminal

from jausml.runtime.transports.ports import FRAME

pytestmark = [pytest.mark.ports, pytest.mark.usefixtures("here")]

STATUS = "02400100000000"
WORDS = "02 00 1000 01 0201c800 01016500 0220 0700"
DATAGRAM = bytes.fromhex(WORDS)


def objects(result):
    return [json.loads(line) for line in result.stdout.splitlines()]


def capture(*datagrams, port=3794, source=5000):
    data = struct.pack("<IHHiIII", 0xA1B2C3D4, 2, 4, 0, 0, 65535, 101)
    for number, datagram in enumerate(datagrams):
        hosts = socket.inet_aton("10.9.0.1") + socket.inet_aton("10.9.0.2")
        udp = struct.pack(">HHHH", source, port, 8 + len(datagram), 0) + datagram
        packet = struct.pack(">BBHHHBBH", 0x45, 0, 20 + len(udp), 1, 0, 9, 17, 0) + hosts + udp
        data += struct.pack("<IIII", 1000 + number, 0, len(packet), len(packet)) + packet
    return data


def test_arguments(jausml):
    result = jausml("decode", "--format", "text", STATUS, "0x02 0x20  # a comment")
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout.splitlines() == [
        "ReportStatus 0x4002 (urn:jaus:jss:core:Management/1.0)",
        "  ReportStatusRec",
        "    Status: 1 (READY)",
        "    Reserved: 0",
        "QueryStatus 0x2002 (urn:jaus:jss:core:Management/1.0)",
    ]


def test_bytes_given_one_by_one_are_one_message(jausml):
    result = jausml("decode", "02", "40", "01", "0x00", "00", "00", "00")
    assert objects(result)[0]["message"] == "ReportStatus"


def test_json(jausml):
    (found,) = objects(jausml("decode", STATUS))
    assert found == {
        "message": "ReportStatus",
        "code": "0x4002",
        "service": "urn:jaus:jss:core:Management",
        "service_version": "1.0",
        "fields": {"ReportStatusRec": {"Status": "READY", "Reserved": 0}},
    }


def test_numbers_of_named_values(jausml, tmp_path):
    (found,) = objects(jausml("decode", "--numbers", STATUS))
    assert found["fields"] == {"ReportStatusRec": {"Status": 1, "Reserved": 0}}
    (tmp_path / "status.json").write_text(json.dumps(found), encoding="utf-8")
    assert jausml("encode", "status.json").output.split() == STATUS.split()


@pytest.mark.parametrize("source", [(), ("-",), ("lines.hex",)])
def test_each_bad_line_is_told_and_the_run_goes_on(jausml, tmp_path, source):
    text = f"# messages\n\n{STATUS}\n02 4z\nffff\n0240\n0220\n"
    (tmp_path / "lines.hex").write_text(text)
    result = jausml("decode", *source, text=text)
    assert result.exit_code == 1
    name = source[0] if source and source[0] != "-" else "<stdin>"
    assert result.stderr.splitlines() == [
        f"{name}:4: column 5: 'z' is no hexadecimal digit",
        f"{name}:5: no message has the code 0xFFFF",
        f"{name}:6: ReportStatusRec.Status: 1 byte wanted at offset 2, 0 left",
    ]
    names = [found.get("message", found.get("error", "")[:10]) for found in objects(result)]
    assert names == ["ReportStatus", "column 5: ", "no message", "ReportStat", "QueryStatus"]


@pytest.mark.parametrize("verb", ["decode", "encode"])
def test_lines_as_windows_writes_them(jausml, tmp_path, verb):
    text = {"decode": "0220", "encode": '{"message": "QueryStatus"}'}[verb]
    (tmp_path / "lines").write_bytes(b"\xef\xbb\xbf" + f"{text}\r\n\r\n{text}\r\n".encode())
    result = jausml(verb, "lines")
    assert (result.exit_code, result.stderr, len(result.stdout.splitlines())) == (0, "", 2)


def test_a_line_without_end_is_refused(refused, tmp_path):
    with (tmp_path / "zeros").open("wb") as stream:
        stream.write(b"0" * 1024)
        stream.truncate(1 << 27)
    refused("zeros: a line has 67108864 bytes or more; this is no text", "decode", "zeros")


def test_an_argument_that_is_neither_file_nor_hex(jausml):
    result = jausml("decode", "nope.hex")
    assert result.exit_code == 1
    reason = "argument 1: neither a file nor hex: column 1: 'n' is no hexadecimal digit"
    assert result.stderr.splitlines() == [reason]


@pytest.mark.parametrize("magic", ["d4c3b2a1", "0a0d0d0a", "1f8b0800"])
def test_a_capture_among_hex_is_told(refused, tmp_path, magic):
    (tmp_path / "drive").write_bytes(bytes.fromhex(magic) + bytes(100))
    refused("drive is a capture, no hex: use --pcap", "decode", "drive")


def test_what_is_neither_text_nor_a_capture_is_told_once(refused, tmp_path):
    (tmp_path / "yard.mcap").write_bytes(b"\x89MCAP0\r\n\x01\x1b\0\0\n\0\n")
    refused("yard.mcap is neither text with hex nor a capture", "decode", "yard.mcap")


def test_a_datagram_among_messages_is_recognized(jausml):
    result = jausml("decode", WORDS)
    assert result.exit_code == 1
    assert "it has the form of a datagram: --datagram" in result.stderr


def test_a_datagram_in_several_arguments(jausml):
    result = jausml("decode", "--datagram", *WORDS.split())
    assert objects(result)[0]["message"]["message"] == "QueryStatus"
    twice = jausml("decode", "--datagram", WORDS, WORDS)
    assert len(objects(twice)) == 2


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no full device")  # noqa: PTH110
@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_a_full_disk_is_told(unbuffered):
    with open("/dev/full", "w") as full:  # noqa: PTH123
        done = subprocess.run(
            [*warm.command(), "decode", STATUS],
            stdout=full,
            stderr=subprocess.PIPE,
            text=True,
            timeout=60,
            check=False,
            env={**os.environ, "PYTHONUNBUFFERED": unbuffered},
        )
    reason = "Error: cannot write the output: No space left on device\n"
    assert (done.returncode, done.stderr) == (2, reason)


def test_count(jausml):
    result = jausml("decode", "--count", 1, text=f"\nzz\n{STATUS}\n0220\n")
    assert "ReportStatus" in result.stdout
    assert "QueryStatus" not in result.stdout


def test_a_name_chooses_between_meanings_of_one_service(jausml):
    payload = "32f90201000000010300414243"
    result = jausml("decode", "--service", "CBRNSensor", payload)
    assert result.exit_code == 1
    assert "name the message that is meant" in result.stderr
    for name in ("RNDetailedMeasurement", "CBDetailedMeasurement"):
        result = jausml("decode", "--message", name, payload)
        assert result.exit_code == 0, result.stderr
        (decoded,) = objects(result)
        assert decoded["message"] == name


def test_a_service_chooses_between_several_meanings(jausml):
    result = jausml("decode", "0226")
    assert result.exit_code == 1
    assert "QueryJointPosition of" in result.stderr
    result = jausml("decode", "--service", "ManipulatorJointPositionSensor/2.0", "0226", STATUS)
    assert result.exit_code == 0
    first, second = objects(result)
    assert (first["message"], second["message"]) == ("QueryJointPositions", "ReportStatus")


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("--service", "Managment", STATUS), "did you mean Management?"),
        (("--message", "ReportStatu", STATUS), "did you mean ReportStatus?"),
        (("--pcap", "absent.pcap"), "absent.pcap: No such file or directory"),
        (("--pcap", "x", STATUS), "give one of HEX or FILE, --pcap, and --listen"),
        (("--model", "absent.xmi", STATUS), "absent.xmi: No such file or directory"),
        (("--listen", "--interface", "nowhere"), "nowhere"),
        (("--listen", "--port", "0"), "0 is not in the range 1<=x<=65535"),
        (("--listen", "--multicast-group", "10.0.0.1"), "not an IPv4 multicast group"),
        (("--listen", "--interface", "192.0.2.1", "--count", "1"), "cannot listen to"),
        (("--format", "xml", STATUS), "xml"),
    ],
)
def test_usage_and_environment(refused, arguments, reason):
    refused(reason, "decode", *arguments)


def test_a_folder_is_no_file(jausml, tmp_path):
    (tmp_path / "folder").mkdir()
    result = jausml("decode", "folder")
    assert (result.exit_code, result.stderr) == (2, "Error: folder: Is a directory\n")
    assert jausml("decode", "").exit_code == 0


@pytest.mark.slow
def test_own_models(jausml, tmp_path):
    (tmp_path / "own.xmi").write_text(
        """<jaus:ServiceSet xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
        xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
        xmlns:jaus="http://www.jausml.org/jaus/1.0" name="own"><services name="Lamp" urn="urn:own">
        <inputs name="SetLamp" code="0xD001" isCommand="true"/></services></jaus:ServiceSet>"""
    )
    assert (
        '"message": "SetLamp", "code": "0xD001"'
        in jausml("decode", "01d0", "--model", "own.xmi").stdout
    )
    assert jausml(
        "list", "messages", "--model", "own.xmi", "--service", "Lamp"
    ).stdout.splitlines()[1:] == ["0xD001  SetLamp  command  urn:own/1.0"]
    line = json.dumps({"message": "SetLamp"})
    assert jausml("encode", "--model", "own.xmi", text=line).stdout == "01d0\n"
    (tmp_path / "own.xmi").write_text("<x/>")
    result = jausml("decode", "01d0", "--model", "own.xmi")
    assert result.exit_code == 1
    assert "own.xmi:1:1" in result.stderr


def test_datagrams(jausml):
    lines = [DATAGRAM.hex(), "01" + DATAGRAM.hex()[2:], "zz", DATAGRAM.hex() + "ff"]
    result = jausml("decode", "--datagram", text="\n".join(lines))
    assert result.exit_code == 1
    good, version_1, malformed, again, rest = objects(result)
    assert good == again
    assert good["message"]["message"] == "QueryStatus"
    assert good["destination"] == {"subsystem": 200, "node": 1, "component": 2}
    assert "version 1" in version_1["error"]
    assert "no hexadecimal digit" in malformed["error"]
    assert "bytes follow" in rest["error"]
    problems = result.stderr.splitlines()
    assert [problem[:9] for problem in problems] == ["<stdin>:2", "<stdin>:3", "<stdin>:4"]
    assert problems[1] == "<stdin>:3: column 1: 'z' is no hexadecimal digit"
    text = jausml("decode", "--format", "text", "--datagram", DATAGRAM.hex())
    assert text.exit_code == 0
    assert text.stdout.startswith("101.1.1 > 200.1.2  #7  QueryStatus 0x2002")


def test_each_bad_datagram_is_told_with_its_place(jausml, tmp_path):
    foreign = "02 00 1000 01 0201c800 01016500 ffff 0700"
    (tmp_path / "lines.hex").write_text(f"{DATAGRAM.hex()}\n0200\n{foreign}\n{DATAGRAM.hex()}\n")
    result = jausml("decode", "--datagram", "lines.hex")
    assert result.exit_code == 1
    cut = "the data size of a message is larger than the datagram (2 bytes)"
    assert result.stderr.splitlines() == [
        f"lines.hex:2: {cut}",
        "lines.hex:3: no message has the code 0xFFFF",
    ]
    first, second, third, last = objects(result)
    assert second == {"error": cut, "place": "lines.hex:2"}
    assert (third["payload"], third["place"]) == ("ffff", "lines.hex:3")
    assert first == last
    assert "place" not in first


def test_captures(jausml, tmp_path):
    path = tmp_path / "a.pcap"
    path.write_bytes(capture(DATAGRAM, FRAME + b"P\1\1\1\1", DATAGRAM))
    result = jausml("decode", "--pcap", path)
    assert result.exit_code == 0
    ends = {"from": "10.9.0.1:5000", "to": "10.9.0.2:3794"}
    first, second = objects(result)
    assert first.items() >= {"number": 1, "time": 1000.0, **ends}.items()
    assert second.items() >= {"number": 3, "time": 1002.0, **ends}.items()
    assert result.stderr == "skipped 1 frames between jausml processes of one host\n"
    assert jausml("decode", "--pcap", path, "--port", 5001).stdout == ""
    assert len(objects(jausml("decode", "--pcap", path, "--count", 1))) == 1


def test_a_capture_shows_who_shares_the_port_and_counts_strangers(jausml, tmp_path):
    ends = ((3794, 5000), (51000, 5000), (50001, 50000))
    frames = [capture(DATAGRAM, port=to, source=source) for to, source in ends]
    head = len(capture())
    (tmp_path / "a.pcap").write_bytes(frames[0] + b"".join(frame[head:] for frame in frames[1:]))
    result = jausml("decode", "--pcap", "a.pcap")
    assert [decoded_message["number"] for decoded_message in objects(result)] == [1, 2]
    assert result.stderr == (
        "a.pcap: skipped 1 datagrams that look like JUDP, between endpoints that were not seen "
        "with port 3794; --port chooses another\n"
    )


def test_a_capture_that_ends_too_early_is_shown_so_far(jausml, tmp_path):
    path = tmp_path / "a.pcap"
    path.write_bytes(capture(DATAGRAM, DATAGRAM)[:-1])
    result = jausml("decode", "--pcap", "a.pcap")
    assert result.exit_code == 1
    assert "QueryStatus" in result.stdout
    assert "a.pcap: the file ends within frame 2 (at byte" in result.stderr


def test_what_is_skipped_is_counted(jausml, tmp_path):
    data = bytearray(capture(DATAGRAM))
    struct.pack_into("<I", data, 36, 500)  # the frame was longer than what was kept
    (tmp_path / "a.pcap").write_bytes(bytes(data[:32]) + struct.pack("<I", 40) + data[36:80])
    result = jausml("decode", "--pcap", "a.pcap")
    assert (result.exit_code, result.stdout) == (0, "")
    assert result.stderr == "a.pcap: skipped 1 frames that were cut\n"


def test_infinity_is_a_string_since_json_has_none():
    from jausml.cli.shared.files import to_json

    assert to_json({"x": [float("inf"), 1.5]}) == '{"x": ["inf", 1.5]}'


# -- live ------------------------------------------------------------------------------------------


@pytest.fixture
def port():
    return free_port()


@pytest.fixture
def listening(port):
    """Starts `jausml decode --listen` and sends to its group."""
    started = []

    def start(*options):
        command = [*warm.command(), "decode", "--listen", "--port", str(port)]
        process = subprocess.Popen(
            [*command, *options], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        started.append(process)
        assert process.stderr.readline().startswith("listening to 239.255.0.1:")
        return process

    yield start
    for process in started:
        process.kill()
        process.wait(10)
        process.stdout.close()
        process.stderr.close()


def send(port):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        interface = socket.inet_aton("127.0.0.1")
        sock.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, interface)
        sock.sendto(DATAGRAM, ("239.255.0.1", port))


def test_listening_ends_after_a_count(listening, port):
    process = listening("--count", "1")
    send(port)
    found = json.loads(process.stdout.readline())
    assert found["message"]["message"] == "QueryStatus"
    assert found["to"] == f"239.255.0.1:{port}"
    assert process.wait(10) == 0


def test_each_message_is_shown_at_once_and_an_interrupt_ends_cleanly(listening, port):
    process = listening()
    send(port)
    assert "QueryStatus" in process.stdout.readline()
    process.send_signal(signal.SIGINT)
    assert process.wait(10) == 0
    assert process.stderr.read() == "interrupted\n"


def test_listening_ends_after_a_duration(jausml, port):
    result = jausml("decode", "--listen", "--port", port, "--duration", "0.01")
    assert (result.exit_code, result.stdout) == (0, "")


# -- encode ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("seconds", ["nan", "inf"])
def test_a_duration_is_a_number_of_seconds(refused, seconds):
    refused(f"'{seconds}' is no finite number", "decode", "--listen", "--duration", seconds)


def test_any_duration_may_be_given(listening, port):
    process = listening("--duration", "1e300", "--count", "1")
    send(port)
    assert process.wait(30) == 0


@pytest.mark.parametrize(
    ("line", "error"),
    [
        ('{"message": "QueryStatus", "feilds": {}}', "feilds: unknown field; did you mean fields?"),
        ('{"message": "QueryStatus", "message": "Reset"}', "'message' stands twice in an object"),
        (
            '{"message": "SetTravelSpeed", "fields": {"TravelSpeedRec": {"Speed": 1, "Speed": 2}}}',
            "'Speed' stands twice in an object",
        ),
        (
            '{"message": "QueryStatus", "service_version": "9"}',
            "service_version: says nothing without a service",
        ),
        ('{"code": -1}', "code: -1 is not a code of four hexadecimal digits"),
        ('{"code": 65536}', "code: 65536 is not a code of four hexadecimal digits"),
        ('{"code": "Quer"}', "code: 'Quer' is not a code of four hexadecimal digits"),
        ('{"code": 1.0}', "code: 1.0 is no code"),
        ("null", "an object is needed, this is null"),
        (
            '{"message": "QueryStatus", "service": "Manage"}',
            "no service 'Manage'; did you mean Management?",
        ),
    ],
)
def test_encode_takes_nothing_that_it_does_not_know(jausml, line, error):
    result = jausml("encode", text=f"{line}\n")
    assert (result.exit_code, result.stdout) == (1, "")
    assert result.stderr.splitlines() == [f"<stdin>:1: {error}"]


def test_encode_takes_what_decode_prints(jausml):
    hexes = ["0220", STATUS, "f14101020700000002400100000000", "02440300000000800000c0ff"]
    printed = jausml("decode", *hexes).stdout
    result = jausml("encode", text=printed)
    assert (result.exit_code, result.stdout.split()) == (0, hexes)
    printed = jausml("decode", "--datagram", DATAGRAM.hex()).stdout
    assert jausml("encode", "-", text=printed).stdout == "0220\n"


@pytest.mark.parametrize("fields", ['{"Speed": 1.5}', '{"TravelSpeedRec": {"Speed": 1.5}}'])
def test_encode_takes_an_argument_and_needs_no_name_of_the_one_record(jausml, fields):
    result = jausml("encode", f'{{"message": "SetTravelSpeed", "fields": {fields}}}')
    assert (result.exit_code, result.stdout) == (0, "0a042c01\n")
    wrong = jausml("encode", '{"message": "SetTravelSpeed", "fields": {"Sped": 1}}')
    assert "argument:1: TravelSpeedRec.Sped: unknown field; did you mean Speed?" in wrong.stderr


@pytest.mark.parametrize("fields", ['{"Speed": 1.5}', "Speed=1.5", "TravelSpeedRec.Speed=1.5"])
def test_encode_takes_a_name_with_fields_in_one_argument(jausml, fields):
    result = jausml("encode", f"SetTravelSpeed {fields}")
    assert (result.exit_code, result.stdout) == (0, "0a042c01\n"), result.output


def test_encode_tells_each_bad_line_and_goes_on(jausml, tmp_path):
    lines = [
        '{"message": "ReportStatus", "fields": {"ReportStatusRec": {"Status": 1, "Reserved": 0}}}',
        "",
        '{"message": "ReportStatus", "fields": {"ReportStatusRec": {"Status": 9, "Reserved": 0}}}',
        '{"message": "ReportStatus", "fields": {"ReportStatusRec": {"Stats": 1}}}',
        '{"message": "ReportStat"}',
        '{"message": ',
        "[1]",
        "[" * 100000,
        '{"message": "X' + "\\ud800" + '"}',
        '{"code": ' + "1" * 5000 + "}",
        '{"code": -1}',
        '{"code": "2002"}',
    ]
    (tmp_path / "lines.jsonl").write_text("\n".join(lines))
    result = jausml("encode", "lines.jsonl")
    assert result.exit_code == 1
    assert result.stdout.split() == [STATUS, "0220"]
    assert result.stderr.splitlines() == [
        "lines.jsonl:3: ReportStatusRec.Status: 9 is not among the legal values 0 (INITIALIZE), "
        "1 (READY), 2 (STANDBY), 3 (SHUTDOWN), 4 (FAILURE), 5 (EMERGENCY)",
        "lines.jsonl:4: ReportStatusRec.Stats: unknown field; did you mean Status?; "
        "ReportStatusRec.Reserved: this field is absent, it takes 0 .. 4294967295",
        "lines.jsonl:5: no message 'ReportStat'; did you mean ReportStatus or ReportPath or "
        "ReportData?",
        "lines.jsonl:6: column 12: Expecting value",
        "lines.jsonl:7: an object is needed, this is a list of 1",
        "lines.jsonl:8: nested too deep",
        "lines.jsonl:9: no message 'X\\ud800' "
        "(messages of your own are known in their project, elsewhere by --model FILE)",
        "lines.jsonl:10: an integer has too many digits",
        "lines.jsonl:11: code: -1 is not a code of four hexadecimal digits",
    ]
    assert jausml("encode", "absent.jsonl").exit_code == 2


def test_a_message_nested_too_deep_is_a_bad_line(jausml):
    line = (
        '{"message":"Event","fields":{"EventRec":{"EventID":0,"SequenceNumber":0,"ReportMessage":'
    )
    text = (line + '{"message":') * 150 + "0" + "}}}}" * 150
    result = jausml("encode", text=text)
    assert result.exit_code == 1
    assert result.stderr == "<stdin>:1: messages are nested too deep in it\n"


# -- list ------------------------------------------------------------------------------------------


def test_list_services(jausml, refused):
    result = jausml("list", "services", "--set", "core")
    head, *rows = result.stdout.splitlines()
    assert head.split() == ["SERVICE", "VERSION", "SET", "INHERITS"]
    assert len(rows) == 16
    row = next(row for row in rows if "Management" in row.split()[0] and " 1.1 " in row)
    assert row.split()[-1] == "urn:jaus:jss:core:AccessControl/1.1"
    found = objects(jausml("list", "services", "--format", "json"))
    assert len(found) == 93
    (management,) = (
        service
        for service in found
        if service["service"].endswith(":Management") and service["version"] == "1.1"
    )
    assert management["outputs"] == ["ReportStatus"]
    assert "Shutdown" in management["inputs"]
    refused("there are: core, environment_sensing", "list", "services", "--set", "cor")


def test_list_messages(jausml, refused):
    everything = objects(jausml("list", "messages", "--format", "json"))
    (shutdown,) = (message for message in everything if message["message"] == "Shutdown")
    del shutdown["services"]
    assert shutdown == {"message": "Shutdown", "code": "0x0002", "command": True}
    assert len(everything) > 300
    inherited = jausml("list", "messages", "--service", "GlobalPoseSensor").stdout
    assert "ReportGlobalPose" in inherited
    assert "CreateEvent" in inherited
    told = "did you mean GlobalPoseSensor or LocalPoseSensor?"
    refused(told, "list", "messages", "--service", "GlobalPoseSenso")


def test_a_terminal_gets_text_and_a_program_json(here):
    command = [*warm.command(), "decode", "0220"]
    with at_terminal(*command, cwd=here) as terminal:
        assert terminal.read_all().startswith("QueryStatus 0x2002 (")
        assert terminal.status() == 0
    piped = subprocess.run(command, capture_output=True, timeout=60, check=True)
    assert json.loads(piped.stdout)["message"] == "QueryStatus"
    chosen = [*command, "--format", "json"]
    assert subprocess.run(chosen, capture_output=True, check=True).stdout == piped.stdout


def test_an_argument_may_be_longer_than_the_name_of_a_file(jausml):
    result = jausml("encode", f'SetTravelSpeed {{{" " * 300}"Speed": 1}}')
    assert result.exit_code == 0, result.output
    assert result.stdout == jausml("encode", 'SetTravelSpeed {"Speed": 1}').stdout


@pytest.mark.parametrize("form", ['SetTravelSpeed {{"Speed": {}}}', "SetTravelSpeed Speed={}"])
def test_fields_that_are_nested_too_deep_are_told(jausml, form):
    result = jausml("encode", text=form.format("[" * 100_000))
    assert (result.exit_code, result.stdout) == (1, "")
    assert result.stderr == "<stdin>:1: the fields are no JSON: nested too deep\n"


def test_a_message_of_ocu_that_is_nested_too_deep_is_refused(refused):
    told = "the message is no JSON: nested too deep"
    refused(told, "ocu", "query", "100.1.1", '{"a":' * 100_000)
