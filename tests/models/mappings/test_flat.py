"""Flat forms of the ready maps do what the readable translations do, whatever comes."""

from __future__ import annotations

import importlib
from functools import cache
from random import Random
from typing import TYPE_CHECKING, Any

import pytest
from codec_strategies import messages
from flat_support import cdr, outcome, ros_value
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from mapping_support import FILES, ready_maps

from jausml.generators.python.codec.message_builder import build_message_map

if TYPE_CHECKING:
    from collections.abc import Callable

    from mapping_support import Translator

NOT_FLAT: dict[str, str] = {}

MAPS = [(path.stem, each) for path in FILES for each in ready_maps()[path.stem]]
TO_ROS = [pytest.param(stem, each, id=each.name) for stem, each in MAPS if each.toRos]
TO_JAUS = [pytest.param(stem, each, id=each.name) for stem, each in MAPS if each.toJaus]
SEEDS = st.integers(0, 2**32)


@cache
def transcoder(bridge: Any, name: str) -> Any:
    """The flat form of a connection; None when it has none."""
    method = getattr(type(bridge), f"translate_{name}")
    factory = getattr(method, "transcoder", None)
    return factory and factory(bridge, getattr(bridge, name))


def encoded(translate: Any) -> Callable[..., bytes | None]:
    """The readable translation to JAUS with bytes as its result."""

    def run(*arguments: Any, **joins: Any) -> bytes | None:
        target = translate(*arguments, **joins)
        return None if target is None else target.encode()

    return run


def joined(each: Any, chance: Random) -> dict[str, Any]:
    """Joined messages of a map by chance."""
    return {
        join.name: ros_value(join.type, chance) if chance.random() < 0.7 else None
        for join in each.joins
    }


@pytest.mark.parametrize(("stem", "each"), TO_JAUS)
@settings(max_examples=10, deadline=None)
@given(seed=SEEDS)
def test_to_jaus(translator: Callable[[str], Translator], stem: str, each: Any, seed: int) -> None:
    bridge, name = translator(stem).bridge, f"{each.name}_to_jaus"
    flat = transcoder(bridge, name)
    if flat is None:
        pytest.skip("not flat")
    chance = Random(seed)
    for _ in range(10):
        source, joins = ros_value(each.type, chance), joined(each, chance)
        connection = getattr(bridge, name)
        readable = encoded(getattr(bridge, f"translate_{name}"))
        expected = outcome(connection, readable, source, **joins)
        for order in "<>":
            data = cdr(each.type, source, order)
            assert outcome(connection, flat, data, **joins) == expected


def serialized(translate: Any, source: Any) -> Callable[[bytes], bytes | None]:
    """The readable translation to ROS with bytes on both sides."""

    def run(data: bytes) -> bytes | None:
        target = translate(source.decode(data))
        return None if target is None else target.to_cdr()

    return run


@pytest.mark.parametrize(("stem", "each"), TO_ROS)
@settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck))
@given(data=st.data(), seed=SEEDS)
def test_to_ros(
    translator: Callable[[str], Translator], stem: str, each: Any, data: Any, seed: int
) -> None:
    bridge, name = translator(stem).bridge, f"{each.name}_to_ros"
    flat = transcoder(bridge, name)
    if flat is None:
        pytest.skip("not flat")
    view = view_of(each.message)
    source = getattr(translator(stem).messages, view.class_name)
    payload = data.draw(strategy(view, source)).encode()
    chance = Random(seed)
    now = importlib.import_module("jausml_runtime.conversions").Time(
        chance.randrange(2**31), chance.randrange(10**9)
    )
    bridge.now = lambda: now
    readable = serialized(getattr(bridge, f"translate_{name}"), source)
    connection = getattr(bridge, name)
    for sent in (payload, *wrong(payload, chance)):
        assert outcome(connection, flat, sent) == outcome(connection, readable, sent)


def wrong(payload: bytes, chance: Random) -> list[bytes]:
    """Payloads of the same code with another byte, less or more of them."""
    made = [payload[: chance.randrange(2, len(payload))], payload + b"\0"]
    for _ in range(20):
        each = bytearray(payload)
        each[chance.randrange(2, len(each))] = chance.choice([0, 1, 0x7F, 0x80, 0xFF, 0x3F])
        made.append(bytes(each))
    return made


@cache
def strategy(view: Any, source: Any) -> Any:
    """Messages of a class with any legal fields."""
    return messages(view, source)


@cache
def view_of(message: Any) -> Any:
    """The class of a JAUS message."""
    return build_message_map([message])[message]


@pytest.mark.parametrize(("stem", "each"), TO_JAUS)
@settings(max_examples=5, deadline=None)
@given(seed=SEEDS)
def test_bytes_that_are_no_message(
    translator: Callable[[str], Translator], stem: str, each: Any, seed: int
) -> None:
    bridge, name = translator(stem).bridge, f"{each.name}_to_jaus"
    flat = transcoder(bridge, name)
    if flat is None:
        pytest.skip("not flat")
    decode_error = importlib.import_module("jausml_runtime").DecodeError
    jaus_error = importlib.import_module("jausml_runtime").JausError
    chance = Random(seed)
    data = cdr(each.type, ros_value(each.type, chance), chance.choice("<>"))
    for cut in {0, 1, 2, 3, 4, *(chance.randrange(len(data)) for _ in range(20))}:
        with pytest.raises(decode_error):
            flat(data[:cut])
    for _ in range(20):
        wrong = bytearray(data)
        wrong[chance.randrange(len(wrong))] = chance.choice([0, 1, 0x7F, 0x80, 0xFF])
        result = outcome(getattr(bridge, name), flat, bytes(wrong)).result
        assert result is None or isinstance(result, bytes) or issubclass(result, jaus_error)
