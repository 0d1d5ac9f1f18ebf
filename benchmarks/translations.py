"""What a translation takes of a processor, from bytes to bytes, in this process and warm.

The same maps in each form: compiled, on light classes, on the message classes of ROS, and
interpreted.
Forms take turns. Decoding and encoding are part of it, publishing and sending are not.
"""

from __future__ import annotations

import gc
import importlib
import random
import time
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import interpreting
import typed_bridge
from figures import Blocks
from names import COMPILED, FORMS, GENERIC, KINDS, LIGHT, READY_MAPS, TYPED, WAYS
from rclpy.serialization import deserialize_message, serialize_message
from samples import sample
from systems import Measured, generate

from jausml.language.metamodel.classes import bridge
from jausml.live.messages import Catalogue

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from samples import Sample
    from scale import Scale

_OWN, _READY = "own_maps", "ready_maps"
"""Packages with the measured maps, and with ready ones."""

_BATCH = 0.004
"""Seconds for which one form runs before the next has its turn."""

_BLOCKS = 12


def measure(scale: Scale, folder: Path) -> dict[str, Any]:
    """Measures each form of each map.

    Args:
        scale: How much.
        folder: Where files may be written.

    Returns:
        Figures by kind, way and form, in microseconds of processor time; ratios are to the
        interpreted form. Ready maps of the library stand under their names; the interpreter here
        does not know what they use, and some have no compiled form.
    """
    kinds = scale.cases(tuple(KINDS), len(KINDS))
    own = tuple(dict.fromkeys(KINDS[each][0] for each in kinds))
    names = scale.cases(tuple(READY_MAPS), len(READY_MAPS))
    system = generate(folder, {_OWN: Measured(own), _READY: Measured(tuple(names))})
    system.compile()
    system.importable()
    forms = _Forms(system.model, _OWN)
    ready = _Forms(system.model, _READY)
    # The model stays; collections must not walk over it, as no bridge has it.
    gc.collect()
    gc.freeze()
    found: dict[str, Any] = {}
    for kind in kinds:
        message = sample(system.model, kind)
        found[kind] = {way: _by_turns(scale, forms.of(message, way)) for way in WAYS}
        told = {way: _told(figures) for way, figures in found[kind].items()}
        print(f"  {kind}: {told}", flush=True)
    for name in names:
        message = ready.sample(name, sample(system.model, READY_MAPS[name][0]))
        found[name] = {way: _by_turns(scale, ready.of(message, way)) for way in WAYS}
        told = {way: _told(figures) for way, figures in found[name].items()}
        print(f"  {name}: {told}", flush=True)
    return found


class _Forms:
    """The forms of the translations of a bridge."""

    def __init__(self, model: Any, package: str) -> None:
        self._base = typed_bridge.bridge_class(package)
        self._bridge = self._base()
        transcoding = importlib.import_module("jausml_runtime.bridge.connections.translations")
        self._typed = typed_bridge.typed(self._base, transcoding.ros_classes)()
        messages = importlib.import_module(f"{package}.messages")
        element = next(each for each in model.instances(bridge.Bridge) if each.name == package)
        self._decode = {
            str(each.map.name): getattr(messages, str(each.map.message.name)).decode
            for each in element.bridgeConnections
        }
        self._interpreters: dict[str, interpreting.Interpreter] = {}
        if package == _OWN:
            self._interpreters = interpreting.interpreters(element, Catalogue(model).message)

    def sample(self, map_name: str, message: Sample) -> Sample:
        """Returns a message as another map carries it."""
        other = replace(message, map=map_name)
        return replace(other, jaus=self._typed_form(other, "down")(message.ros))

    def of(self, message: Sample, way: str) -> dict[str, tuple[Callable[[bytes], Any], bytes]]:
        """Returns the forms that there are of one translation, and what they are given."""
        name = f"{message.map}_{way}"
        method = getattr(self._bridge, f"translate_{name}")
        found = {TYPED: self._typed_form(message, way)}
        if name in self._interpreters:
            found[GENERIC] = _interpreted(self._interpreters[name], message.ros_class, way)
        light = _light_class(method, message)
        if light is not None:
            found[LIGHT] = self._light_form(message, way, light)
        compiled = getattr(method, "compiled", None)
        if compiled is not None:
            note = getattr(self._bridge, name).drop_field.unknown
            found[COMPILED] = compiled.of(self._bridge, self._base.core.load(), note)
        given = message.jaus if way == "up" else message.ros
        for form, translate in found.items():
            assert translate(given) is not None, f"{form} of {name} passes nothing on"
        return {form: (translate, given) for form, translate in found.items()}

    def _typed_form(self, message: Sample, way: str) -> Callable[[bytes], Any]:
        translate = getattr(self._typed, f"translate_{message.map}_{way}")
        if way == "up":
            decode = self._decode[message.map]
            return lambda data: serialize_message(translate(decode(data)))
        return lambda data: translate(deserialize_message(data, message.ros_class)).encode()

    def _light_form(self, message: Sample, way: str, light: Any) -> Callable[[bytes], Any]:
        translate = getattr(self._bridge, f"translate_{message.map}_{way}")
        if way == "up":
            decode = self._decode[message.map]
            return lambda data: translate(decode(data)).to_cdr()
        return lambda data: translate(light.from_cdr(data)).encode()


def _light_class(method: Any, message: Sample) -> Any:
    """Returns the light class of a ROS type, None where the bridge has none."""
    found = method.__func__.__globals__.get(message.ros_class.__name__)
    return found if hasattr(found, "from_cdr") else None


def _interpreted(
    interpreter: interpreting.Interpreter, ros_class: Any, way: str
) -> Callable[[bytes], Any]:
    if way == "up":
        return lambda data: serialize_message(interpreter.to_ros(data))
    return lambda data: interpreter.to_jaus(deserialize_message(data, ros_class))


def _by_turns(
    scale: Scale, forms: dict[str, tuple[Callable[[bytes], Any], bytes]]
) -> dict[str, Any]:
    blocks = Blocks()
    order = list(forms.items())
    for _ in range(scale.count(_BLOCKS, 2)):
        blocks.begin()
        random.shuffle(order)
        for form, (translate, given) in order:
            blocks.add(form, _microseconds(translate, given))
    return blocks.summary(against=GENERIC)


def _microseconds(translate: Callable[[bytes], Any], given: bytes) -> float:
    """Returns the processor time of one call."""
    calls = 1
    while (used := _seconds(translate, given, calls)) < _BATCH / 2:
        calls *= max(min(int(_BATCH / max(used, 1e-7)), 16), 2)
    return 1e6 * used / calls


def _seconds(translate: Callable[[bytes], Any], given: bytes, calls: int) -> float:
    start = time.thread_time()
    for _ in range(calls):
        translate(given)
    return time.thread_time() - start


def _told(figures: dict[str, Any]) -> str:
    return ", ".join(f"{form} {figures[form]['median']}" for form in FORMS if form in figures)
