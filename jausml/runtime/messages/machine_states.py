"""Messages of MachineStates: where the state machines of a component are, and for how long.

The service is of this project, in no standard. Its codes are of the range for experiments, D000 to
FFFF (JAUS Reference Architecture 3.3), and there of the parts that others use for queries, E000 to
EFFF, and for reports, F000 to FFFF.
"""

# Annotations are read when the classes are made: no `from __future__ import annotations`.
from dataclasses import dataclass, field
from typing import Annotated, TypeAlias

from ..wire.codec import U32, ShortList, Text, unsigned
from ..wire.layout import Bodiless, message, record
from ..wire.message import Message

MACHINE_STATES = "urn:jausml:MachineStates"


@record("TimeRec")
@dataclass(slots=True)
class _TimeRec:
    """How often a state was entered, and the time spent in it."""

    state: Text = ""
    entries: U32 = 0
    milliseconds: Annotated[int, unsigned(8)] = 0


@record("MachineRec")
@dataclass(slots=True)
class _MachineRec:
    """A machine of a service, its present state, and how long it has been in it."""

    service: Text = ""
    machine: Text = ""
    state: Text = ""
    milliseconds: Annotated[int, unsigned(8)] = 0


@record("MachineSeq")
@dataclass(slots=True)
class _MachineSeq:
    """A machine and its times."""

    machine_rec: _MachineRec = field(default_factory=_MachineRec)
    time_list: ShortList[_TimeRec] = field(default_factory=list)


class _WithMachines(Message):
    __slots__ = ()

    MachineSeq: TypeAlias = _MachineSeq
    MachineRec: TypeAlias = _MachineRec
    TimeRec: TypeAlias = _TimeRec


@message(0xEA20)
class QueryMachineStates(Bodiless):
    __slots__ = ()


@message(0xFA20)
@dataclass(slots=True, repr=False, eq=False)
class ReportMachineStates(_WithMachines):
    """Tells the present states, and of the states that were entered those with the most time."""

    machine_list: ShortList[_MachineSeq] = field(default_factory=list)
