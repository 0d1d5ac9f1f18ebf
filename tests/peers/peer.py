"""A small JAUS component of another make, with faults to order; shares no service with ours."""

import re
import select
import socket
import threading
import time

from jausml.runtime import messages as core
from jausml.runtime.base.counters import Counters
from jausml.runtime.transports.packets.packet import AckNak, DataFlags, Packet, parse_datagram
from jausml.runtime.transports.packets.reassembly import Reassembly
from jausml.runtime.wire.message import DecodeError

LOOPBACK = "127.0.0.1"
SERVICES = ("Transport", "Events", "AccessControl", "Management", "Discovery", "Liveness")
STANDBY, READY, EMERGENCY = 2, 1, 5
MANAGEMENT = tuple(
    message_class.CODE.to_bytes(2, "little")
    for message_class in (
        *(core.Shutdown, core.Standby, core.Resume, core.Reset),
        *(core.SetEmergency, core.ClearEmergency),
    )
)
CONTROL_TIMEOUT = 1
INPUTS = {
    member.CODE: member
    for member in vars(core).values()
    if isinstance(member, type) and hasattr(member, "CODE")
}


class FaultyPeer:
    """Serves the core services of v1.1 on its own thread.

    Attributes:
        faults: Names of what it shall do wrong.
    """

    def __init__(self, address, port, *faults):
        self.address = address
        self.faults = set(faults)
        self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.socket.bind((LOOPBACK, port))
        self.endpoints = {}
        self.seen = {}
        self.lost = []
        self.reassembly = Reassembly(3.0, 1 << 20, Counters())
        self.sequence = 100
        self.controller = None
        self.authority = self.default = 5
        self.state = STANDBY
        self.emergencies = set()
        self.lapses = 0.0
        self.events = {}
        self.shared_number = 0
        self.dead = False
        self.running = True
        self.thread = threading.Thread(target=self.serve, daemon=True)
        self.thread.start()

    def close(self):
        self.running = False
        self.thread.join()
        self.socket.close()

    # ---- the wire ---------------------------------------------------------------------------

    def serve(self):
        while self.running:
            readable, _, _ = select.select([self.socket], [], [], 0.01)
            if readable:
                self.take(*self.socket.recvfrom(65535))
            self.tick()

    def take(self, data, sender):
        if "reads version 3" in self.faults and data[:1] == b"\x03":
            data = b"\x02" + data[1:]
        if "dies of short datagrams" in self.faults and len(data) < 10:
            self.dead = True
        for packet in parse_datagram(data, Counters()):
            if not self.dead and not self.loses(packet.payload):
                self.packet(packet, sender)

    def loses(self, payload):
        is_command = payload[:2] in MANAGEMENT and "loses each first command" in self.faults
        is_lost = is_command and payload not in self.lost
        self.lost += [payload] * is_lost
        return is_lost

    def packet(self, packet, sender):
        mine = packet.destination == self.address
        if packet.destination.is_wildcard and "needs the broadcast flag" not in self.faults:
            mine = packet.destination.matches(self.address)
        if not mine and "answers for others" not in self.faults:
            return
        if packet.acknowledge >= AckNak.NAK:
            return
        self.endpoints[packet.source] = sender
        known = (packet.source, packet.sequence) in self.seen
        self.acknowledge(packet, known)
        if known and "takes duplicates" not in self.faults:
            return
        self.seen[packet.source, packet.sequence] = True
        payload = packet.payload
        if packet.data_flags is not DataFlags.SINGLE:
            if "reads no fragments" in self.faults:
                return
            whole = self.reassembly.add(packet, time.monotonic())
            if whole is None:
                return
            payload = whole.payload
        if len(payload) >= 2:
            self.message(payload, packet.source)

    def acknowledge(self, packet, known):
        wanted = packet.acknowledge is AckNak.REQUESTED or "acks everything" in self.faults
        if not wanted or (known and "acks duplicates never" in self.faults):
            return
        payload = packet.payload if "acks with payload" in self.faults else b""
        number = packet.sequence + ("acks another number" in self.faults) & 0xFFFF
        flags = DataFlags.LAST if "acks as last fragment" in self.faults else DataFlags.SINGLE
        answer = Packet(
            packet.source,
            self.address,
            payload,
            number,
            packet.priority,
            acknowledge=AckNak.ACK,
            data_flags=flags,
        )
        for _ in range(1 + ("acks twice" in self.faults)):
            self.put(answer)

    def put(self, packet):
        data = packet.encode()
        if "appends garbage" in self.faults:
            data += b"\0\0\0"
        self.socket.sendto(data, self.endpoints[packet.destination])

    def send(self, message, client, extra=b""):
        if client not in self.endpoints or "answers nothing" in self.faults:
            return
        if "counts nothing" not in self.faults:
            self.sequence = self.sequence + 1 & 0xFFFF
        payload = message.encode() + extra
        self.put(Packet(client, self.address, payload, self.sequence))

    def message(self, payload, sender):
        code = int.from_bytes(payload[:2], "little")
        message_class = INPUTS.get(code)
        if message_class is None:
            if "answers the unknown" in self.faults:
                self.send(core.ReportStatus(status=self.state), sender)
            return
        try:
            message = message_class.decode(payload)
        except DecodeError:
            self.dead = self.dead or "dies of truncated bodies" in self.faults
            return
        words = re.findall("[A-Z][a-z]+", message_class.__name__)
        handler = getattr(self, f"on_{'_'.join(words).lower()}", None)
        if handler is not None:
            handler(message, sender)

    # ---- AccessControl ----------------------------------------------------------------------

    @property
    def available(self):
        return self.state != EMERGENCY or "controlled in emergency" in self.faults

    def on_request_control(self, message, sender):
        code = message.authority_code
        low = code < self.default and "takes any authority" not in self.faults
        other = self.controller not in (None, sender)
        answer = 0
        if not self.available:
            answer = 1
        elif sender == self.controller and code < self.default:
            self.drop(0)
            return
        elif sender != self.controller and (low or (other and not self.preempts(code))):
            answer = 2
        if answer == 0:
            former = self.controller
            self.controller, self.authority = sender, code
            if former != sender or "renews no control" not in self.faults:
                self.lapses = time.monotonic() + CONTROL_TIMEOUT
            if "lapses early" in self.faults:
                self.lapses -= 0.7 * CONTROL_TIMEOUT
            if former not in (None, sender) and "preempts in silence" not in self.faults:
                self.send(core.RejectControl(response_code=0), former)
        self.send(core.ConfirmControl(response_code=answer), sender)

    def preempts(self, code):
        if "lower preempts" in self.faults:
            return True
        if "equal preempts" in self.faults:
            return code >= self.authority
        return code > self.authority

    def on_release_control(self, _message, sender):
        if self.controller is None and "releases in silence" not in self.faults:
            refused = not self.available and sender not in self.emergencies
            self.send(core.RejectControl(response_code=int(refused)), sender)
        elif sender == self.controller or "released by anybody" in self.faults:
            self.drop(0)

    def on_set_authority(self, message, sender):
        trusted = sender == self.controller or "authority by anybody" in self.faults
        legal = self.default <= message.authority_code <= self.authority
        if trusted and (legal or "authority raised" in self.faults):
            self.authority = message.authority_code

    def drop(self, reason):
        former, self.controller, self.authority = self.controller, None, self.default
        if self.state == READY and "stays ready" not in self.faults:
            self.state = STANDBY
        if former is not None:
            self.send(core.RejectControl(response_code=reason), former)

    def on_query_control(self, _message, sender):
        if "says not who controls it" in self.faults:
            return
        client = self.controller
        parts = (client.subsystem, client.node, client.component) if client else (0, 0, 0)
        self.send(core.ReportControl(*parts, self.authority), sender)

    def on_query_authority(self, _message, sender):
        if "says not which authority" in self.faults:
            return
        wrong = "reports another authority" in self.faults
        self.send(core.ReportAuthority(self.authority + wrong), sender)

    def on_query_timeout(self, _message, sender):
        self.send(core.ReportTimeout(CONTROL_TIMEOUT), sender)

    # ---- Management -------------------------------------------------------------------------

    def obeys(self, sender):
        return sender == self.controller or "obeys anybody" in self.faults

    def on_resume(self, _message, sender):
        wrong = self.state == EMERGENCY and "resumes in emergency" in self.faults
        if wrong or (self.obeys(sender) and self.state == STANDBY):
            self.state = READY

    def on_standby(self, _message, sender):
        if self.obeys(sender) and self.state == READY:
            self.state = STANDBY

    def on_reset(self, _message, sender):
        wrong = self.state == EMERGENCY and "resets in emergency" in self.faults
        if wrong or (self.obeys(sender) and self.state in (READY, STANDBY)):
            self.drop(0)
            self.state = STANDBY

    def on_set_emergency(self, _message, sender):
        if "ignores emergencies" in self.faults:
            return
        self.emergencies.add(sender)
        if self.state != EMERGENCY:
            self.state = EMERGENCY
            if "keeps its controller in emergency" not in self.faults:
                self.drop(1)

    def on_clear_emergency(self, _message, sender):
        if sender not in self.emergencies and "cleared by anybody" not in self.faults:
            return
        self.emergencies.discard(sender)
        if "first clears all" in self.faults or "cleared by anybody" in self.faults:
            self.emergencies.clear()
        if self.state == EMERGENCY and not self.emergencies:
            self.state = READY if "clears to ready" in self.faults else STANDBY

    def on_query_status(self, _message, sender):
        extra = b"\0\0" if "trailing bytes" in self.faults else b""
        self.send(core.ReportStatus(status=self.state), sender, extra)

    # ---- Discovery and Liveness -------------------------------------------------------------

    def on_query_identification(self, message, sender):
        if message.query_type == 4:
            wrong = "identifies as another scope" in self.faults
            self.send(core.ReportIdentification(2 if wrong else 4, 60001, "peer"), sender)

    def on_query_services(self, message, sender):
        own = self.address
        wanted = any(
            node.node_rec.node_id in (own.node, 255) and record.component_id in (own.component, 255)
            for node in message.node_list
            for record in node.component_list
        )
        self.send(
            self.listed(core.ReportServices, SERVICES)
            if wanted
            else core.ReportServices(node_list=[]),
            sender,
        )

    def on_query_service_list(self, _message, sender):
        kind = core.ReportServiceList
        names = SERVICES[:-1] if "lists differ" in self.faults else SERVICES
        inner = self.listed(kind, names, seq=True)
        subsystem = kind.SubsystemSeq(kind.SubsystemRec(self.address.subsystem), inner)
        self.send(kind(subsystem_list=[subsystem]), sender)

    def listed(self, kind, names, seq=False):
        records = [kind.ServiceRec(f"urn:jaus:jss:core:{name}", 1, 1) for name in names]
        component = kind.ComponentSeq(kind.ComponentRec(self.address.component, 0), records)
        nodes = [kind.NodeSeq(kind.NodeRec(self.address.node), [component])]
        return nodes if seq else kind(node_list=nodes)

    def on_query_heartbeat_pulse(self, _message, sender):
        if "has no pulse" not in self.faults:
            self.send(core.ReportHeartbeatPulse(), sender)

    # ---- Events -----------------------------------------------------------------------------

    def on_create_event(self, message, sender):
        if self.report(message.query_message, sender) is None:
            code = 4 if "rejects with another code" in self.faults else 5
            self.send(core.RejectEventRequest(message.request_id, code), sender)
            return
        silly = message.event_type > 1 and "takes any event type" not in self.faults
        if silly or (message.event_type == 0 and not message.requested_periodic_rate):
            self.send(core.RejectEventRequest(message.request_id, 4), sender)
            return
        number = next(index for index in range(200) if index not in self.events)
        event = {
            "client": sender,
            "query": message.query_message,
            "type": message.event_type,
            "rate": message.requested_periodic_rate,
            "sequence": 0,
            "last": None,
            "due": time.monotonic(),
        }
        self.events[number] = event
        confirm = core.ConfirmEventRequest(
            message.request_id + ("confirms another request" in self.faults), number, event["rate"]
        )
        if "reports before it confirms" in self.faults:
            self.deliver(number, event)
        self.send(confirm, sender)
        self.deliver(number, event)

    def on_update_event(self, message, sender):
        event = self.events.get(message.event_id)
        if event is not None:
            event["rate"] = message.requested_periodic_rate
            self.send(
                core.ConfirmEventRequest(message.request_id, message.event_id, event["rate"]),
                sender,
            )
        elif "ignores unknown events" not in self.faults:
            self.send(core.RejectEventRequest(message.request_id, 6), sender)

    def on_cancel_event(self, message, sender):
        event = self.events.get(message.event_id)
        if event is None or event["client"] != sender:
            confirmed = core.ConfirmEventRequest(message.request_id, message.event_id, 0.0)
            rejected = core.RejectEventRequest(message.request_id, 6)
            anything = "confirms any cancellation" in self.faults
            self.send(confirmed if anything else rejected, sender)
            return
        if "goes on after cancel" not in self.faults:
            del self.events[message.event_id]
        self.send(core.ConfirmEventRequest(message.request_id, message.event_id, 0.0), sender)

    def on_query_events(self, message, sender):
        choice = message.query_events_var
        everything = "lists all events" in self.faults
        found = [
            core.ReportEvents.ReportEventRec(min(event["type"], 1), number, event["query"])
            for number, event in self.events.items()
            if (everything or getattr(choice, "event_id", number) == number)
            and getattr(choice, "event_type", event["type"]) == event["type"]
        ]
        if "lists no events" in self.faults:
            found = []
        self.send(core.ReportEvents(event_list=found), sender)

    def on_query_event_timeout(self, _message, sender):
        self.send(core.ReportEventTimeout(1), sender)

    def on_create_command_event(self, message, sender):
        self.send(core.RejectEventRequest(message.request_id, 5), sender)

    def report(self, query, sender):
        """Returns the payload that answers a query, by answering it to nobody."""
        code = int.from_bytes(query[:2], "little")
        if code not in (0x2002, 0x200D, 0x2001, 0x2202):
            return None
        sent = []
        self.send = lambda message, *_: sent.append(message)
        try:
            self.message(query, sender)
        finally:
            del self.send
        return sent[0].encode() if sent else None

    def deliver(self, number, event):
        payload = self.report(event["query"], event["client"])
        if event["type"] == 1 and payload == event["last"]:
            return
        event["last"] = payload
        if "sends the query back" in self.faults:
            payload = event["query"]
        self.shared_number = self.shared_number + 1 & 0xFF
        count = self.shared_number if "numbers all events as one" in self.faults else None
        sequence = event["sequence"] if count is None else count
        self.send(core.Event(number, sequence, payload), event["client"])
        event["sequence"] = event["sequence"] + 1 & 0xFF

    def tick(self):
        now = time.monotonic()
        if self.dead:
            return
        lapses = self.controller is not None and now > self.lapses
        if lapses and self.available and "never lapses" not in self.faults:
            self.drop(0)
        for number, event in list(self.events.items()):
            period = 0.0 if event["type"] else 1 / event["rate"]
            if "sends too often" in self.faults:
                period /= 4
            if now >= event["due"] + period:
                event["due"] = now
                self.deliver(number, event)
