"""Messages of MachineStates: the states of a component's machines, and their durations.

The service is of this project, in no standard. Its codes are of the range for experiments, D000 to
FFFF (JAUS Reference Architecture 3.3): E000 to EFFF is used for queries, F000 to FFFF for reports.
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
    """The entries into a state, and the total time in it."""

    state: Text = ""
    entries: U32 = 0
    milliseconds: Annotated[int, unsigned(8)] = 0


@record("MachineRec")
@dataclass(slots=True)
class _MachineRec:
    """A machine of a service, its present state, and the time since its entry."""

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
    """Reports the present states, and for each machine the entered states with the most time."""

    machine_list: ShortList[_MachineSeq] = field(default_factory=list)
