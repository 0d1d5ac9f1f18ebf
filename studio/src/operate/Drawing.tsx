import { useCallback, useEffect, useState } from "react";
import { usePolled } from "../answers";
import { Fault, Order, Quiet, Select } from "../panels/base/parts";
import { DrawingPlan } from "./DrawingPlan";
import {
  type Drawing,
  type Driver,
  load,
  movedTo,
  type Progress,
  placeIn,
  progressOf,
  readWaypoints,
  save,
} from "./drawing";
import { FieldsForm } from "./FieldsForm";
import { type Draft, type Faults, rangesOf, readNumber } from "./fields";
import { trackOf } from "./Plan";
import { lengthOf, type Place, refusalAround } from "./plan";
import { ask, commands, tell, tried, useAnswer, useUnit } from "./unit";

const LOOK_MS = 1000;
/** Reports each second of where it is and of what it drives to. */
const RATE = 2;
const MOST = 1000;

interface Props {
  component: string;
  drivers: Driver[];
}

/** Waypoints that a person draws, sends and has executed; nothing of it happens by itself. */
export default function DrawingPanel({ component, drivers }: Props) {
  const [service, setService] = useState(drivers[0]?.service);
  const driver = drivers.find((candidate) => candidate.service === service);
  return (
    <section className="drawing" aria-label="Waypoints">
      <h2>Waypoints for {component}</h2>
      {drivers.length > 1 && (
        <label>
          Driver
          <Select
            label="Driver"
            value={service ?? ""}
            options={drivers.map((candidate) => [candidate.service, candidate.service])}
            onChoose={setService}
          />
        </label>
      )}
      {driver && <Waypoints key={driver.service} component={component} driver={driver} />}
    </section>
  );
}

interface Of {
  component: string;
  driver: Driver;
}

function Waypoints({ component, driver }: Of) {
  const { frame, isList } = driver;
  const { value: form, error } = useAnswer("form", { component, message: frame.waypoint });
  const fields = form?.fields ?? [];
  const [drawing, setDrawing] = useState(() => load(localStorage, component, driver));
  const [chosen, setChosen] = useState(-1);
  const [isTried, setTried] = useState(false);
  const { track, age, reports } = useReports(component, driver);
  const { waypoints } = drawing;
  const { values, faults } = readWaypoints(fields, waypoints);
  const places = waypoints.map((waypoint) => placeIn(waypoint, fields, frame));
  const placed = places.filter((place) => place !== undefined);
  const origin = frame.hasOrigin
    ? (drawing.origin ?? placed[0] ?? track.at(-1))
    : ([0, 0] as Place);
  const refusal = origin && refusalAround(frame, origin);
  const progress = isList ? progressOf(drawing, waypoints.length, reports) : undefined;

  function put(changes: Partial<Drawing>) {
    // What is drawn while a list is sent stays; so does where the plan was begun.
    setDrawing((before) => ({ ...before, ...(origin && { origin }), ...changes }));
  }
  useEffect(() => {
    try {
      save(localStorage, component, driver, drawing);
    } catch {
      tell("The browser does not keep what is drawn: it has no room.", true);
    }
  }, [component, driver, drawing]);
  // Where nothing is drawn any more, a plan may begin at another place.
  const set = (drafts: Draft[]) =>
    put({ waypoints: drafts, ...(drafts.length === 0 && { origin: null }) });
  const change = (at: number, draft: Draft) => set(waypoints.with(at, draft));
  const move = (at: number, place: Place) =>
    change(at, movedTo(waypoints[at] ?? {}, fields, frame, place));
  function add(place?: Place) {
    const drawn = place ? movedTo({}, fields, frame, place) : {};
    if (!isList && waypoints.length > 0) {
      if (place) move(0, place);
    } else if (waypoints.length >= MOST) tell(`${MOST} waypoints are the most.`, true);
    else set([...waypoints, drawn]);
    if (!place) setChosen(isList ? waypoints.length : 0);
  }
  function remove(at: number) {
    set(waypoints.toSpliced(at, 1));
    setChosen(-1);
  }
  function swap(at: number, other: number) {
    const [one, two] = [waypoints[at], waypoints[other]];
    if (one === undefined || two === undefined) return;
    set(waypoints.with(at, two).with(other, one));
    setChosen(other);
  }

  return (
    <>
      <Fault>{error}</Fault>
      {refusal && <Quiet>{refusal}</Quiet>}
      {!origin && (
        <Quiet>
          The plan needs a place to begin at: enter the first waypoint as numbers, or let the
          component tell its global pose.
        </Quiet>
      )}
      {origin && !refusal && fields.length > 0 && (
        <DrawingPlan
          frame={frame}
          origin={origin}
          places={places}
          track={track}
          age={age}
          progress={progress}
          chosen={chosen}
          onChoose={setChosen}
          onMove={move}
          onAdd={add}
          onRemove={remove}
        />
      )}
      <ol className="waypoints" aria-label="Waypoints in their order">
        {waypoints.map((_, at) => (
          // biome-ignore lint/suspicious/noArrayIndexKey: waypoints have no other name
          <li key={at} className="bar">
            <button type="button" aria-pressed={at === chosen} onClick={() => setChosen(at)}>
              Waypoint {at + 1}: {textOf(places[at], driver)}
            </button>
            <strong className="mark">
              {progress?.active === at + 1 && "▶ active"}
              {progress?.isReached(at + 1) && "✔ reached"}
            </strong>
            <Order
              name={`waypoint ${at + 1}`}
              at={at}
              count={waypoints.length}
              onMove={(to) => swap(at, to)}
              onRemove={() => remove(at)}
            />
          </li>
        ))}
      </ol>
      <button type="button" onClick={() => add()}>
        Add waypoint
      </button>
      {isList && (
        <span>
          {" "}
          Length on the plan: {lengthOf(frame, placed).toFixed(1)} m
          {placed.length < waypoints.length && ", without those that have no place"}
        </span>
      )}
      {waypoints[chosen] !== undefined && (
        <fieldset>
          <legend>Waypoint {chosen + 1}</legend>
          <FieldsForm
            key={chosen}
            fields={fields}
            draft={waypoints[chosen]}
            path={`elements[${chosen}]`}
            faults={faults}
            isTried={isTried}
            onDraft={(draft) => change(chosen, draft)}
          />
        </fieldset>
      )}
      <Sending
        component={component}
        driver={driver}
        drawing={drawing}
        values={values}
        faults={faults}
        progress={progress}
        onDrawing={put}
        onTried={() => setTried(true)}
      />
    </>
  );
}

function textOf(place: Place | undefined, { frame }: Driver): string {
  if (!place) return "has no place yet";
  const units = frame.hasOrigin ? "°" : " m";
  return place.map((coordinate, axis) => `${frame.paths[axis]} ${coordinate}${units}`).join(", ");
}

/** Where the component is and was, and the elements that it told to be active. */
function useReports(component: string, { frame, isList }: Driver) {
  useEffect(() => {
    for (const report of [frame.report, ...(isList ? [ACTIVE] : [])])
      ask("watch", { component, report, rate: RATE }).catch(() => undefined); // it tells none
  }, [component, frame, isList]);
  const look = useCallback(async () => {
    const asked = { component, report: ACTIVE, path: "ElementUID", seconds: 3600, points: 2000 };
    const { values: track, age } = await trackOf(frame, component);
    return { track, age, reports: isList ? await ask("history", asked) : NO_REPORTS };
  }, [component, frame, isList]);
  return usePolled(look, LOOK_MS) ?? { track: [], age: 0, reports: NO_REPORTS };
}

const ACTIVE = "ReportActiveElement";
const NO_REPORTS: { times: number[]; values: number[] } = { times: [], values: [] };

interface SendingProps extends Of {
  drawing: Drawing;
  values: Record<string, unknown>[];
  faults: Faults;
  progress: Progress | undefined;
  onDrawing(changes: Partial<Drawing>): void;
  onTried(): void;
}

/** Sends what is drawn, has it executed at a speed that is typed, and ends that. */
function Sending(props: SendingProps) {
  const { component, driver, drawing, values, faults, progress, onDrawing } = props;
  const { frame, isList, execution } = driver;
  const [speed, setSpeed] = useState("");
  const [chosenFirst, setFirst] = useState(1);
  // Of waypoints that were taken away none is the first.
  const first = chosenFirst <= values.length ? chosenFirst : 1;
  const [isBusy, setBusy] = useState(false);
  const isOurs = useUnit(commands);
  const isHeld = useUnit((unit) => unit.state?.holds.some((hold) => hold.component === component));
  const asked = execution ? { component, message: execution } : null;
  const record = useAnswer("form", asked).value?.fields[0];
  const members = record?.kind === "group" ? record.members : [];
  const speedField = members.find((member) => member.name === "Speed");
  const speedKind = speedField?.kind === "number" ? speedField : null;
  const speedFaults: Faults = new Map();
  const wanted = speedKind && readNumber(speedKind, speed, false, "Speed", speedFaults);
  const fault = speed === "" ? undefined : speedFaults.get("Speed");
  const mayCommand = isOurs && isHeld === true && !isBusy;
  const isSent = drawing.sent !== "" && drawing.sent === JSON.stringify(values);

  async function doing(work: () => Promise<unknown>) {
    setBusy(true);
    await work();
    setBusy(false);
  }
  async function send() {
    props.onTried();
    const [wrong] = faults;
    if (wrong) {
      tell(`Nothing is sent: ${wrong[0]}: ${wrong[1]}`, true);
      return;
    }
    onDrawing({ sent: "", execution: null });
    const message = frame.waypoint;
    const done = isList
      ? await tried("list.set", { component, message, elements: values })
      : await tried("send", { component, message, fields: values[0] ?? {} });
    if (done === undefined) return;
    onDrawing({ sent: JSON.stringify(values), execution: null });
    tell(`${component} has what is drawn.`);
  }
  async function execute() {
    if (typeof wanted !== "number" || speedFaults.size > 0) return;
    if (!isList) {
      await drive(wanted);
      return;
    }
    const drawn = { component, message: frame.waypoint, elements: values };
    const done = await tried("list.execute", { ...drawn, speed: wanted, first });
    if (done) onDrawing({ execution: { time: done.time, first } });
  }
  async function drive(speed: number) {
    if (execution) await tried("send", { component, message: execution, fields: { Speed: speed } });
  }
  async function end() {
    if (!isList) await drive(0);
    else if ((await tried("list.end", { component })) !== undefined) onDrawing({ sent: "" });
  }

  return (
    <fieldset className="sending">
      <legend>Send and execute</legend>
      <p className="quiet">
        {isList
          ? "Send replaces the list of the component; one that it executes ends with that. End has it stand, and empties its list."
          : execution
            ? "Send sets the waypoint: if the component has a speed, it drives there at once. Speed 0 has it stand."
            : "Send sets the waypoint, and the component may drive there at once: it takes no speed."}
      </p>
      <button
        type="button"
        disabled={!mayCommand || values.length === 0}
        onClick={() => void doing(send)}
      >
        Send {values.length} waypoint{values.length === 1 ? "" : "s"}
      </button>{" "}
      {execution && (
        <>
          <label>
            Speed, {speedKind && rangesOf(speedKind)}{" "}
            <input
              size={6}
              inputMode="decimal"
              autoComplete="off"
              value={speed}
              aria-invalid={fault !== undefined}
              onChange={(event) => setSpeed(event.currentTarget.value)}
            />
          </label>{" "}
          {isList && (
            <label>
              from waypoint{" "}
              <Select
                label="from waypoint"
                value={first}
                options={values.map((_, at) => [at + 1, `${at + 1}`])}
                onChoose={(at) => setFirst(Number(at))}
              />
            </label>
          )}{" "}
          <button
            type="button"
            className="best"
            disabled={!mayCommand || !isSent || speed === "" || fault !== undefined}
            onClick={() => void doing(execute)}
          >
            Execute
          </button>{" "}
          <button type="button" disabled={!isOurs || isHeld !== true} onClick={() => void end()}>
            {isList ? "End the list" : "Speed 0"}
          </button>
        </>
      )}
      <Fault>{fault ?? ""}</Fault>
      <output>
        {isSent
          ? "The component has confirmed what is drawn. "
          : drawing.sent
            ? "Changed since it was sent. "
            : "Not sent. "}
        {!(isOurs && isHeld) && "Take control first. "}
        {progress?.text}
      </output>
    </fieldset>
  );
}
