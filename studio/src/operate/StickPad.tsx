import { type KeyboardEvent, type PointerEvent, useEffect, useRef, useState } from "react";
import { Quiet } from "../panels/base/parts";
import {
  type Axis,
  axesOf,
  type Draft,
  type Faults,
  rangesOf,
  readGroup,
  withNumber,
} from "./fields";
import { HeldStick } from "./holding";
import type { Command, Field } from "./protocol";

interface Props {
  command: Command;
  component: string;
  fields: Field[];
  draft: Draft;
  isAllowed: boolean;
}

/** Where the hand is: right and up are positive, 1 is full. */
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
const KEYS: Record<string, Place> = {
  ArrowUp: { x: 0, y: 1 },
  ArrowDown: { x: 0, y: -1 },
  ArrowLeft: { x: -1, y: 0 },
  ArrowRight: { x: 1, y: 0 },
};

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
  const pointer = useRef<{ pad: Element; id: number } | null>(null);

  const faults: Faults = new Map();
  const moved = [
    { way: up, part: place.y, name: "up" },
    { way: right, part: place.x, name: "right" },
  ].reduce((before, { way, part, name }) => {
    const axis = axes.find((each) => each.steps.join(".") === way.axis);
    if (!axis) return before;
    const full = Number(way.full);
    if (way.full.trim() === "" || !Number.isFinite(full)) faults.set(name, "Say what full is.");
    else if (!fits(axis, full) || !fits(axis, -full)) {
      faults.set(name, `Full is not within ${rangesOf(axis.kind)} both ways.`);
    }
    return withNumber(before, axis.steps, part * full);
  }, draft);
  const isIdle = up.axis === "" && right.axis === "";
  present.current = readGroup(fields, moved, "", faults);
  const isReady = isAllowed && !isIdle && faults.size === 0;

  /** Takes the stick in hand; false where it cannot be. */
  function begin(): boolean {
    if (!isReady || held.current) return false;
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

  function onPointer(event: PointerEvent<HTMLDivElement>) {
    if (!held.current && event.type !== "pointerdown") return;
    const box = event.currentTarget.getBoundingClientRect();
    const part = (at: number, size: number) => Math.max(-1, Math.min(1, (2 * at) / size - 1));
    setPlace({
      x: part(event.clientX - box.left, box.width),
      y: -part(event.clientY - box.top, box.height),
    });
  }

  function onKey(event: KeyboardEvent) {
    if (!(event.key in KEYS)) return;
    event.preventDefault();
    if (event.type === "keydown") keys.current.add(event.key);
    else keys.current.delete(event.key);
    if (keys.current.size === 0) return end();
    const directions = [...keys.current].flatMap((each) => KEYS[each] ?? []);
    setPlace({
      x: directions.reduce((sum, each) => sum + each.x, 0),
      y: directions.reduce((sum, each) => sum + each.y, 0),
    });
    if (!event.repeat) begin();
  }

  const { stop, timeout, source } = command.stick as Exclude<Command["stick"], { refusal: string }>;
  return (
    <fieldset className="stick">
      <legend>Stick</legend>
      <p className="quiet">
        Released, hidden or silent for {timeout} s, it is followed by its stop: {stop} ({source}).
      </p>
      <WayInput label="Up and down" way={up} axes={axes} fault={faults.get("up")} onWay={setUp} />
      <WayInput
        label="Right and left"
        way={right}
        axes={axes}
        fault={faults.get("right")}
        onWay={setRight}
      />
      <div
        className={isHeld ? "pad held" : "pad"}
        role="application"
        aria-label={`Stick of ${command.name}: hold it, or hold an arrow key`}
        aria-disabled={!isReady}
        // biome-ignore lint/a11y/noNoninteractiveTabindex: it takes arrows while it has the focus
        tabIndex={0}
        onPointerDown={(event) => {
          if (event.button !== 0) return;
          onPointer(event);
          if (!begin()) return;
          pointer.current = { pad: event.currentTarget, id: event.pointerId };
          event.currentTarget.setPointerCapture(event.pointerId);
        }}
        onPointerMove={onPointer}
        onPointerUp={end}
        onPointerCancel={end}
        onLostPointerCapture={end}
        onContextMenu={(event) => event.preventDefault()}
        onKeyDown={onKey}
        onKeyUp={onKey}
        onBlur={end}
      >
        <svg viewBox="-1.1 -1.1 2.2 2.2" aria-hidden="true">
          <path d="M-1 0H1M0-1V1" />
          <circle cx={isHeld ? place.x : 0} cy={isHeld ? -place.y : 0} r="0.1" />
        </svg>
      </div>
      {!isReady && (
        <Quiet>
          {!isAllowed
            ? "Take control first."
            : isIdle
              ? "Choose what the stick moves."
              : "Fields of the command are missing, or full is not said."}
        </Quiet>
      )}
    </fieldset>
  );
}

const fits = ({ kind }: Axis, value: number): boolean =>
  kind.ranges.some(([low, high]) => low <= value && value <= high);

interface WayProps {
  label: string;
  way: Way;
  axes: Axis[];
  fault: string | undefined;
  onWay(way: Way): void;
}

function WayInput({ label, way, axes, fault, onWay }: WayProps) {
  const axis = axes.find((each) => each.steps.join(".") === way.axis);
  return (
    <div className="way">
      <label>
        {label}
        <select
          aria-label={label}
          value={way.axis}
          onChange={(event) => onWay({ ...way, axis: event.currentTarget.value })}
        >
          <option value="">nothing</option>
          {axes.map((each) => (
            <option key={each.steps.join(".")} value={each.steps.join(".")}>
              {each.steps.at(-1)}
            </option>
          ))}
        </select>
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
      {axis && way.full !== "" && fault && <span className="field-fault">✖ {fault}</span>}
    </div>
  );
}
