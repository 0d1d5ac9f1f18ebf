"""The C++ headers with messages: the vectors, damaged ones too, and names that C++ has itself."""

import re
import struct
import subprocess
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import Any

import needs
import pytest
from codec_support import FieldNames, load, render
from generated import model_of, texts_of
from scripts import succeeded
from sweeps import sweep
from wire_vectors import given, payload_of, vectors

from jausml.generation.native import compiler
from jausml.generation.rendering import render as render_artifacts
from jausml.generation.target import FileTask, Target
from jausml.language.metamodel.classes import jaus
from jausml.runtime import wire
from jausml_generators.codec_cpp.target import TARGET, HeaderView
from jausml_generators.cpp.jaus_numbers import NUMBERS
from jausml_generators.cpp.types import (
    JAUS,
    Choice,
    Elements,
    Struct,
    cpp_class,
    cpp_name,
    cpp_number,
    support,
)
from jausml_generators.python.codec.examples import example_bytes
from jausml_generators.python.codec.message_builder import build_message_map

GUARDS = ("tests/vectors", "generators/jausml_generators/cpp")

pytestmark = pytest.mark.timeout(400)

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
EVERY_KIND = HERE / "every_kind.xmi"
MODELS = [
    *sorted({ROOT / vector["model"] for vector in vectors()}),
    HERE / "hostile_messages.xmi",
    HERE / "cpp_names.xmi",
]
STRICT = ("-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Werror")
BARE = ("-fno-exceptions", "-fno-rtti")
WATCHED = ("-fsanitize=address,undefined", "-fno-sanitize-recover=all")

STATUS = [
    "ok", "other code", "ends too early", "bytes left over", "unknown bit", "no such option",
    "count not legal", "not legal",
]  # fmt: skip
KINDS = {
    "no code": "ends too early", "no such type": "no such option",
    "count beyond the end": "ends too early", "length beyond the end": "ends too early",
    "count too large": "count not legal", "length too large": "count not legal",
    "length not legal": "count not legal", "too long": "count not legal",
    "out of range": "not legal", "NUL": "not legal",
}  # fmt: skip
"""What the status of an error is called where it has another name than in the vectors."""

TURN = "void turn_named(const std::string& name, const Bytes& bytes)"
LETTERS = {cpp: letter for letter, cpp in NUMBERS.items() if letter not in "fd"}


@pytest.fixture(scope="module")
def program() -> str:
    needs.ask("compiler")
    return str(compiler())


def watched(program: str) -> tuple[str, ...]:
    """Returns the flags of the sanitizers where the compiler has them."""
    command = [program, "-print-file-name=libasan.so"]
    found = subprocess.run(command, capture_output=True, text=True, check=False).stdout
    return WATCHED if Path(found.strip()).is_absolute() else ()


def compiled(program: str, *arguments: object) -> None:
    command = [program, *map(str, arguments)]
    succeeded(command)


def header(folder: Path, view: HeaderView) -> None:
    task = FileTask("messages.hpp.j2", [view], lambda _: "messages.hpp")
    target = Target("codec_cpp", "", lambda _: [task], template_folders=TARGET.template_folders)
    (artifact,) = render_artifacts(None, [target])
    (folder / "messages.hpp").write_text(artifact.text, encoding="utf-8")
    (folder / JAUS).write_text(support(JAUS), encoding="utf-8")


# -- the vectors ----------------------------------------------------------------------------------


def sent(service: jaus.Service) -> list[jaus.MessageDef]:
    return [*service.inputs, *service.outputs]


@dataclass
class Messages:
    """The messages of all vectors in both languages."""

    view: HeaderView
    names: dict[tuple[str, str], FieldNames]

    @classmethod
    def read(cls, models):
        model = model_of(*models)
        shown = {(ROOT / vector["model"], vector["message"]) for vector in vectors()}
        # Of the library those of vectors are enough; test_cpp_codecs has the others.
        services = [
            service
            for service in model.instances(jaus.Service)
            if (path := Path(model.location(service).path).resolve()) in models
            and (path.parent == HERE or any((path, m.name) in shown for m in sent(service)))
        ]
        found = build_message_map(message for service in services for message in sent(service))
        view = HeaderView("vectors", "vectors", services)
        module = load(render(view.messages), "messages_of_cpp")
        names = {
            (Path(model.location(element).path).resolve().name, element.name): FieldNames(
                message, module
            )
            for element, message in found.items()
        }
        return cls(view, names)

    def of(self, vector: dict[str, Any]) -> FieldNames:
        return self.names[Path(vector["model"]).name, vector["message"]]

    def struct(self, names: FieldNames) -> Struct:
        return self.view.codec.structs[names.view.class_name]


def statements(target: str, kind: Any, value: Any) -> Iterator[str]:
    """Yields what gives a value of Python to a place of C++.

    Raises:
        ValueError: The type excludes it.
    """
    match kind:
        case Struct():
            for attribute, member in kind.members.items():
                inner, place = getattr(value, attribute), f"{target}.{member.name}"
                if inner is not None and member.is_optional:
                    yield f"{place}.emplace();"
                    place = f"(*{place})"
                if inner is not None:
                    yield from statements(place, member.type, inner)
        case Choice():
            own = f"_{type(value).__name__}"
            (at,) = (n for n, e in enumerate(kind.options) if e.own_name.endswith(own))
            yield f"{target}.emplace<{at}>();"
            yield from statements(f"std::get<{at}>({target})", kind.options[at], value)
        case Elements():
            if kind.count not in {0, len(value)}:
                raise ValueError("another number of elements")
            yield from [] if kind.count else [f"{target}.resize({len(value)});"]
            for at, item in enumerate(value[: kind.most or None]):
                yield from statements(f"{target}[{at}]", kind.of, item)
        case _:
            yield f"{target} = {literal(kind, value)};"


def literal(kind: Any, value: Any) -> str:
    if isinstance(value, str):
        data = "".join(f"\\{byte:03o}" for byte in value.encode("latin-1"))
        return f'std::string_view("{data}", {len(value)})'
    if kind.cpp in LETTERS:
        try:
            struct.pack(LETTERS[kind.cpp], value)
        except struct.error as error:
            raise ValueError(str(error)) from None
    return cpp_number(value)


def damaged(payload: bytes, chance: Random) -> Iterator[bytes]:
    """Yields a payload with other bytes, less or more of them."""
    yield from (payload[:size] for size in range(len(payload)))
    yield payload + b"\0"
    for _ in range(40):
        changed = bytearray(payload)
        for _ in range(chance.randrange(1, 4)):
            at = chance.randrange(1, len(changed))
            changed[at] = chance.choice([0, 1, 2, 0x7F, 0x80, 0xFF, chance.randrange(256)])
        yield bytes(changed)


@dataclass
class Run:
    """What the program said.

    Attributes:
        vectors: Those that it was made of.
        given: Stage, status and bytes of messages with given fields, by name of the vector.
        decoded: The same of payloads, by class of Python and payload.
    """

    vectors: list[dict[str, Any]]
    given: dict[str, tuple[str, str, str]]
    decoded: dict[tuple[Any, bytes], tuple[str, str, str]]


def fields(vector: dict[str, Any]) -> dict[str, Any] | None:
    return given(vector) if "fields" in vector else None


def told(line: str) -> tuple[str, str, str]:
    stage, number, *made = line.split()
    return stage, STATUS[int(number)], made[0] if made else ""


@pytest.fixture(scope="module")
def messages(sanitizers: tuple[str, ...]) -> Messages:
    # Sanitizers take long to compile: they watch one message of each kind.
    return Messages.read([EVERY_KIND] if sanitizers else MODELS)


@pytest.fixture(scope="module", params=sweep(["plain", "watched"], every=2))
def sanitizers(request: pytest.FixtureRequest, program: str) -> tuple[str, ...]:
    """Returns the flags of the sanitizers, or none."""
    if request.param == "plain":
        return ()
    if flags := watched(program):
        return flags
    pytest.skip("the compiler has no sanitizers")


@pytest.fixture(scope="module")
def run(
    program: str,
    sanitizers: tuple[str, ...],
    messages: Messages,
    tmp_path_factory: pytest.TempPathFactory,
) -> Run:
    folder = tmp_path_factory.mktemp("codec_cpp")
    header(folder, messages.view)
    chosen = [v for v in vectors() if not sanitizers or ROOT / v["model"] == EVERY_KIND]
    made: dict[str, str] = {}
    payloads: dict[tuple[Any, bytes], str] = {}
    chance = Random(7)

    def add(names: FieldNames, payload: bytes) -> None:
        payloads[names, payload] = messages.struct(names).own_name

    for vector in chosen:
        names, payload = messages.of(vector), payload_of(vector)
        if fields(vector) is not None:
            try:
                message = names.from_fields(fields(vector))
                lines = statements("message", messages.struct(names), message)
                made[vector["name"]] = " ".join(lines)
            except ValueError:
                assert "error" in vector
        if payload is not None:
            add(names, payload)
        if payload is not None and "error" not in vector:
            for variant in damaged(payload, chance):
                add(names, variant)
    for (file, _), names in messages.names.items():
        if file in {"hostile_messages.xmi", "cpp_names.xmi"}:
            add(names, example_bytes(names.view))
    structs = {vector["name"]: messages.struct(messages.of(vector)).cpp for vector in chosen}
    setters = [
        f"given<{structs[name]}>([]({structs[name]}& message) {{ (void)message; {lines} }});"
        for name, lines in made.items()
    ]
    turns = [
        f'if (name == "{name}") return turn<jaus::{name}>(bytes);'
        for name in dict.fromkeys(payloads.values())
    ]
    (folder / "vectors.inc").write_text(
        "\n".join(
            [f"void make_given() {{ {' '.join(setters)} }}", f"{TURN} {{ {' '.join(turns)} }}"]
        ),
        encoding="utf-8",
    )
    (folder / "payloads").write_text(
        "".join(f"{name} {payload.hex()}\n" for (_, payload), name in payloads.items()),
        encoding="utf-8",
    )
    flags = (*STRICT, *sanitizers, f"-I{folder}")
    compiled(program, *flags, HERE / "codec_cpp.cpp", "-o", folder / "turn")
    said = succeeded([folder / "turn", folder / "payloads"])
    lines = [told(line) for line in said.stdout.splitlines()]
    at = len(made)
    return Run(
        chosen,
        dict(zip(made, lines[:at], strict=True)),
        dict(zip(payloads, lines[at:], strict=True)),
    )


def test_the_vectors(messages, run):
    for vector in run.vectors:
        name, payload = vector["name"], payload_of(vector)
        kind = vector["error"]["kind"] if "error" in vector else "ok"
        status = KINDS.get(kind, kind)
        if name in run.given:
            _, found, made = run.given[name]
            whole = payload.hex() if payload is not None and status == "ok" else ""
            assert (found, made) == (status, whole), name
        if payload is not None:
            stage, found, made = run.decoded[messages.of(vector), payload]
            if status != "ok":
                assert (stage, found) == ("decoded", status), name
            elif fields(vector) is not None:
                assert (found, made) == ("ok", payload.hex()), name
            else:
                assert stage == "encoded", name


def test_few_errors_are_excluded_by_the_types(run):
    encoded = [vector for vector in run.vectors if fields(vector) is not None]
    left = [vector["error"]["kind"] for vector in encoded if vector["name"] not in run.given]
    assert {"not Latin-1"} <= {*left} <= {"not Latin-1", "not legal", "number of elements"}
    assert len(run.given) > 0.8 * len(encoded)


def test_damaged_payloads_are_treated_as_in_python(run):
    stages = set()
    for (names, payload), said in run.decoded.items():
        try:
            expected = ("encoded", "ok", names.cls.decode(payload).encode().hex())
        except wire.DecodeError:
            expected = ("decoded", "", "")
        except wire.EncodeError:
            expected = ("encoded", "", "")
        found = said if said[1] == "ok" else (said[0], "", "")
        assert found == expected, (names.view.jaus_name, payload.hex(), said)
        stages.add(expected[:2])
    assert len(stages) == 3


# -- the text -------------------------------------------------------------------------------------


@pytest.mark.needs("compiler")
def test_no_macro_of_the_standard_library_is_a_name():
    source = (HERE / "codec_cpp.cpp").read_text(encoding="utf-8")
    includes = "".join(re.findall(r"#include <.*\n", source))
    command = [str(compiler()), "-std=c++17", "-dM", "-E", "-x", "c++", "-"]
    text = succeeded(command, input=includes).stdout
    names = re.findall(r"^#define (\w+)(?= )", text, re.MULTILINE)
    assert {"EOF", "errno", "INT_MAX"} <= {*names}
    assert not [n for n in names if re.fullmatch("[A-Z][A-Za-z0-9]*", n) and cpp_class(n) == n]
    assert not [n for n in names if re.fullmatch("[a-z][a-z0-9_]*", n) and cpp_name(n) == n]


@pytest.mark.slow
def test_the_whole_library_compiles_for_small_computers(program, tmp_path):
    model = model_of(ROOT / "models" / "catvehicle" / "catvehicle.xmi")
    for path, text in texts_of(model, [TARGET.for_whole_library()]).items():
        (tmp_path / Path(path).name).write_text(text, encoding="utf-8")
        assert all(len(line) <= 100 for line in text.splitlines())
        assert text.isascii()
    (tmp_path / "small.cpp").write_text(SMALL, encoding="utf-8")
    flags = (*STRICT, *BARE, "-Os", "-DJAUSML_NO_HEAP", "-c", "-o", tmp_path / "small.o")
    compiled(program, *flags, tmp_path / "small.cpp")
    needed = succeeded(["nm", "-u", tmp_path / "small.o"]).stdout.split()
    assert not [symbol for symbol in needed if re.match("_Zn|_Zd|malloc|__cxa", symbol)]


SMALL = """
#include "catvehicle_jaus.hpp"

jausml::Outcome answer(const std::uint8_t* data, std::size_t size, std::uint8_t* buffer) {
    jaus::ReportServices services;
    jaus::SetWrenchEffort effort;
    if (const auto found = jausml::decode(data, size, effort); !found) return found;
    if (const auto found = jausml::decode(data, size, services); !found) return found;
    return jausml::encode(services, buffer, 100);
}
"""


def test_more_than_fits_is_refused_without_heap(program, tmp_path):
    (tmp_path / JAUS).write_text(support(JAUS), encoding="utf-8")
    (tmp_path / "full.cpp").write_text(FULL, encoding="utf-8")
    compiled(program, *STRICT, *BARE, "-o", tmp_path / "full", tmp_path / "full.cpp")
    assert subprocess.run([tmp_path / "full"], check=False).returncode == 0


FULL = """
#define JAUSML_NO_HEAP
#define JAUSML_INLINE_BYTES 4
#include "jaus.hpp"

struct Names {
    static constexpr std::uint16_t CODE = 1;
    jausml::Text<65535> name;
    void read(jausml::JausInput& in) { in.counted<std::uint8_t>(name, 65535u); }
    void write(jausml::JausOutput& out) const { out.counted<std::uint8_t>(name, 0, 65535u); }
};

int main() {
    const std::uint8_t payload[] = {1, 0, 5, 'a', 'b', 'c', 'd', 'e'};
    std::uint8_t room[20];
    Names names;
    if (jausml::decode(payload, 8, names).status != jausml::Status::no_room) return 1;
    names.name = std::string_view("abcd");
    if (jausml::encode(names, room, sizeof room).size != 7) return 2;
    names.name.push_back('e');
    if (jausml::encode(names, room, sizeof room)) return 3;
    names.name.clear();
    return jausml::encode(names, room, sizeof room) ? 0 : 4;
}
"""


def test_a_header_is_the_same_each_time():
    model = model_of(ROOT / "models" / "catvehicle" / "catvehicle.xmi")
    first, second = (render_artifacts(model, [TARGET]) for _ in range(2))
    assert first == second
    assert [artifact.path for artifact in first] == [
        "codec_cpp/catvehicle_jaus.hpp",
        "codec_cpp/jaus.hpp",
    ]
