import { type KeyboardEvent, type PointerEvent, useEffect, useRef, useState } from "react";
import { createPortal } from "react-dom";
import { Quiet, Select } from "../panels/base/parts";
import {
  type Axis,
  axesOf,
  type Draft,
  type Faults,
  faultOfFull,
  readGroup,
  valueAt,
  withNumber,
} from "./fields";
import { HeldStick } from "./holding";
import type { Command, Field } from "./protocol";
import { tell } from "./unit";

/** The place of the stick, which is the same at any time: see `operate.css`. */
export const DOCK = "dock-pad";

interface Props {
  command: Command;
  component: string;
  fields: Field[];
  draft: Draft;
  isAllowed: boolean;
}

/** Where the hand is from where it pressed: right and up are positive, 1 is full. */
interface Place {
  x: number;
  y: number;
}

interface Way {
  axis: string;
  /** Value at full deflection, as typed: nobody but a person knows it. */
  full: string;
}

const CENTRE: Place = { x: 0, y: 0 };
const NO_WAY: Way = { axis: "", full: "" };
/** Part of full that a press of an arrow adds, again while it is held. */
const STEP = 0.1;
const KEYS: Record<string, Place> = {
  ArrowUp: { x: 0, y: STEP },
  ArrowDown: { x: 0, y: -STEP },
  ArrowLeft: { x: -STEP, y: 0 },
  ArrowRight: { x: STEP, y: 0 },
};

const within = (part: number): number => Math.max(-1, Math.min(1, part));

/** A stick for a rate: it commands while it is held, and its stop follows, whatever happens. */
export function StickPad(props: Props) {
  const axes = axesOf(props.fields);
  const { stick } = props.command;
  if ("refusal" in stick) return <Quiet>{`No stick: ${stick.refusal}.`}</Quiet>;
  if (axes.length === 0) return null;
  return <Pad {...props} axes={axes} />;
}

function Pad({ command, component, fields, draft, isAllowed, axes }: Props & { axes: Axis[] }) {
  const [up, setUp] = useState(NO_WAY);
  const [right, setRight] = useState(NO_WAY);
  const [place, setPlace] = useState(CENTRE);
  const [isHeld, setHeld] = useState(false);
  const held = useRef<HeldStick | null>(null);
  const present = useRef<object>({});
  const keys = useRef(new Set<string>());
  const pointer = useRef<{ pad: Element; id: number; x: number; y: number } | null>(null);

  const faults: Faults = new Map();
  const values: Record<string, number> = {};
  const moved = [
    { way: up, part: place.y, name: "up" },
    { way: right, part: place.x, name: "right" },
  ].reduce((before, { way, part, name }) => {
    const axis = axisOf(axes, way);
    if (!axis) return before;
    const fault = faultOfFull(axis.kind, way.full);
    if (fault) faults.set(name, fault);
    values[name] = valueAt(axis.kind, part, Number(way.full));
    return withNumber(before, axis.steps, values[name]);
  }, draft);
  const isIdle = up.axis === "" && right.axis === "";
  present.current = readGroup(fields, moved, "", faults);
  const isReady = isAllowed && !isIdle && faults.size === 0;

  /** Takes the stick in hand; false where it cannot be. */
  function begin(pad: Element): boolean {
    if (!isReady || held.current) return false;
    if (!isWhollySeen(pad)) {
      tell("The stick is not wholly in the window: make it larger.", true);
      return false;
    }
    const stick = new HeldStick(
      () => present.current,
      () => {
        held.current = null;
        keys.current.clear();
        // Else the next click, wherever it is, would be on the pad and hold the stick again.
        const taken = pointer.current;
        pointer.current = null;
        if (taken?.pad.hasPointerCapture(taken.id)) taken.pad.releasePointerCapture(taken.id);
        setHeld(false);
        setPlace(CENTRE);
      },
    );
    held.current = stick;
    setHeld(true);
    void stick.begin(component, command.name);
    return true;
  }
  const end = () => held.current?.end();
  useEffect(() => () => held.current?.end(), []);

  // From where the hand pressed, not from where the pad is: nothing that moves the pad moves it.
  function onMove(event: PointerEvent<HTMLDivElement>) {
    const pressed = pointer.current;
    if (!held.current || !pressed) return;
    const half = event.currentTarget.clientWidth / 2;
    setPlace({
      x: within((event.clientX - pressed.x) / half),
      y: within((pressed.y - event.clientY) / half),
    });
  }

  function onKey(event: KeyboardEvent) {
    const step = KEYS[event.key];
    if (!step || pointer.current) return;
    event.preventDefault();
    if (event.type === "keyup") {
      keys.current.delete(event.key);
      if (keys.current.size === 0) end();
      return;
    }
    if (!held.current && (event.repeat || !begin(event.currentTarget))) return;
    keys.current.add(event.key);
    setPlace(({ x, y }) => ({ x: within(x + step.x), y: within(y + step.y) }));
  }

  // One number cannot follow both ways.
  const besides = (way: Way) => axes.filter((axis) => axis !== axisOf(axes, way));
  const { stop, timeout, source } = command.stick as Exclude<Command["stick"], { refusal: string }>;
  const dock = document.getElementById(DOCK);
  const pad = (
    <>
      <div
        className={isHeld ? "pad held" : "pad"}
        role="application"
        aria-label={`Stick of ${command.name}: hold it and move, or hold an arrow key`}
        aria-disabled={!isReady}
        // biome-ignore lint/a11y/noNoninteractiveTabindex: it takes arrows while it has the focus
        tabIndex={0}
        onPointerDown={(event) => {
          if (event.button !== 0 || !begin(event.currentTarget)) return;
          const { currentTarget, pointerId, clientX, clientY } = event;
          pointer.current = { pad: currentTarget, id: pointerId, x: clientX, y: clientY };
          currentTarget.setPointerCapture(pointerId);
        }}
        onPointerMove={onMove}
        onPointerUp={end}
        onPointerCancel={end}
        onLostPointerCapture={end}
        onContextMenu={(event) => event.preventDefault()}
        onKeyDown={onKey}
        onKeyUp={onKey}
        onBlur={end}
      >
        <svg viewBox="-1.1 -1.1 2.2 2.2" aria-hidden="true">
          <path d="M-1 0H1M0-1V1M-.5-.04V.04M.5-.04V.04M-.04-.5H.04M-.04 .5H.04" />
          <circle cx={place.x} cy={-place.y} r="0.1" />
        </svg>
        <Scale axes={axes} way={up} ends={["top", "bottom"]} />
        <Scale axes={axes} way={right} ends={["right", "left"]} />
      </div>
      <output className="pad-said">
        {isReady
          ? shown(axes, up, values.up) + shown(axes, right, values.right)
          : !isAllowed
            ? "Take control first."
            : isIdle
              ? "Choose what the stick moves."
              : "Fields are missing, or full is not said."}
      </output>
    </>
  );
  return (
    <fieldset className="stick">
      <legend>Stick</legend>
      <p className="quiet">
        Released, hidden or silent for {timeout} s, it is followed by its stop: {stop} ({source}).
        Its zero is where you press; half the width of the pad is full.
      </p>
      <WayInput
        label="Up and down"
        way={up}
        axes={besides(right)}
        fault={faults.get("up")}
        onWay={setUp}
      />
      <WayInput
        label="Right and left"
        way={right}
        axes={besides(up)}
        fault={faults.get("right")}
        onWay={setRight}
      />
      {dock && createPortal(pad, dock)}
    </fieldset>
  );
}

const axisOf = (axes: Axis[], { axis }: Way): Axis | undefined =>
  axes.find((candidate) => candidate.steps.join(".") === axis);

function isWhollySeen(pad: Element): boolean {
  const { left, top, right, bottom, width } = pad.getBoundingClientRect();
  return width > 0 && left >= 0 && top >= 0 && right <= innerWidth && bottom <= innerHeight;
}

function shown(axes: Axis[], way: Way, value: number | undefined): string {
  const axis = axisOf(axes, way);
  if (!axis || value === undefined) return "";
  return `${axis.steps.at(-1)} ${Number(value.toPrecision(3))} ${axis.kind.units} `;
}

/** What the ends of a way mean, in numbers. */
function Scale({ axes, way, ends }: { axes: Axis[]; way: Way; ends: [string, string] }) {
  const axis = axisOf(axes, way);
  if (!axis || faultOfFull(axis.kind, way.full)) return null;
  return [1, -1].map((part, index) => (
    <span key={part} className={`scale ${ends[index]}`} aria-hidden="true">
      {valueAt(axis.kind, part, Number(way.full))} {axis.kind.units}
    </span>
  ));
}

interface WayProps {
  label: string;
  way: Way;
  axes: Axis[];
  fault: string | undefined;
  onWay(way: Way): void;
}

function WayInput({ label, way, axes, fault, onWay }: WayProps) {
  const axis = axisOf(axes, way);
  return (
    <div className="way">
      <label>
        {label}
        <Select
          label={label}
          value={way.axis}
          options={[
            ["", "nothing"],
            ...axes.map(({ steps }) => [steps.join("."), steps.at(-1) ?? ""] as const),
          ]}
          onChoose={(axis) => onWay({ ...way, axis })}
        />
      </label>
      {axis && (
        <label>
          at full
          <input
            size={7}
            inputMode="decimal"
            aria-label={`${label}: value at full`}
            value={way.full}
            aria-invalid={way.full !== "" && fault !== undefined}
            onChange={(event) => onWay({ ...way, full: event.currentTarget.value })}
          />
          {axis.kind.units}
        </label>
      )}
      {axis && way.full !== "" && fault && <span className="fault">✖ {fault}</span>}
    </div>
  );
}
