import { type KeyboardEvent, type PointerEvent, useRef, useState } from "react";
import { Quiet } from "../panels/base/parts";
import type { Progress } from "./drawing";
import { oldOf } from "./Plan";
import { around, barOf, type Frame, type Place, type Point, placeOf } from "./plan";
import { tell } from "./unit";

const LEAST_M = 20;
/** Steps of an arrow key in a length of the grid; more with Shift. */
const STEPS = 10;
/** Pixels that a pointer may move and still point. */
const STILL = 4;
const ARROWS: Record<string, Point> = {
  ArrowUp: { up: 1, right: 0 },
  ArrowDown: { up: -1, right: 0 },
  ArrowRight: { up: 0, right: 1 },
  ArrowLeft: { up: 0, right: -1 },
};

interface Props {
  frame: Frame;
  origin: Place;
  /** Where the waypoints are, undefined for those that are nowhere yet. */
  places: (Place | undefined)[];
  track: Place[];
  /** Seconds since the last place of the track. */
  age: number;
  progress: Progress | undefined;
  chosen: number;
  onChoose(at: number): void;
  onMove(at: number, place: Place): void;
  onAdd(place: Place): void;
  onRemove(at: number): void;
}

/** The plan that waypoints are drawn on, by a pointer or by keys. */
export function DrawingPlan(props: Props) {
  const { frame, origin, places, track, progress, chosen } = props;
  const points = places.map((place) => place && frame.pointOf(...place, origin));
  const been = track.map((place) => frame.pointOf(...place, origin));
  const all = [...points.filter((point) => point !== undefined), ...been];
  const fitting = () => around(all.length > 0 ? all : [{ up: 0, right: 0 }], LEAST_M);
  const [view, setView] = useState<[number, number, number]>(fitting);
  const [cursor, setCursor] = useState<Point>({ up: 0, right: 0 });
  const [isFocused, setFocused] = useState(false);
  const drawn = useRef<SVGSVGElement>(null);
  const held = useRef<{ at: number; x: number; y: number; hasMoved: boolean } | null>(null);
  const [left, top, size] = view;
  const grid = barOf(size);
  const here = been.at(-1);

  /** Does something with the place of a point, or says why it is none. */
  function put(point: Point, then: (place: Place) => void) {
    const place = placeOf(frame, point, origin);
    if (typeof place === "string") tell(place, true);
    else then(place);
  }

  function pointAt(event: PointerEvent): Point {
    const matrix = drawn.current?.getScreenCTM()?.inverse();
    const { x, y } = new DOMPoint(event.clientX, event.clientY).matrixTransform(matrix);
    return { up: -y, right: x };
  }

  function onDown(event: PointerEvent<HTMLElement>) {
    if (event.button !== 0) return;
    const at = Number((event.target as Element).getAttribute("data-at") ?? -1);
    held.current = { at, x: event.clientX, y: event.clientY, hasMoved: false };
    if (at >= 0) {
      props.onChoose(at);
      event.currentTarget.setPointerCapture(event.pointerId);
    }
  }

  function onMove(event: PointerEvent) {
    const hand = held.current;
    if (!hand) return;
    hand.hasMoved ||= Math.hypot(event.clientX - hand.x, event.clientY - hand.y) > STILL;
    if (hand.hasMoved && hand.at >= 0) put(pointAt(event), (place) => props.onMove(hand.at, place));
  }

  function onUp(event: PointerEvent) {
    const hand = held.current;
    held.current = null;
    if (hand && hand.at < 0 && !hand.hasMoved) put(pointAt(event), props.onAdd);
  }

  function onKey(event: KeyboardEvent) {
    const arrow = ARROWS[event.key];
    const from = points[chosen] ?? cursor;
    if (arrow) {
      const step = event.shiftKey ? grid : grid / STEPS;
      const point = { up: from.up + step * arrow.up, right: from.right + step * arrow.right };
      if (points[chosen]) put(point, (place) => props.onMove(chosen, place));
      else setCursor(point);
    } else if (event.key === "Enter") put(cursor, props.onAdd);
    else if (event.key === "Delete" && chosen >= 0) props.onRemove(chosen);
    else if (event.key === "Escape" && chosen >= 0) props.onChoose(-1);
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  const zoom = (by: number) =>
    setView([left + (size * (1 - by)) / 2, top + (size * (1 - by)) / 2, size * by]);
  const line = points.filter((point) => point !== undefined);
  return (
    <figure className="plan" aria-label="Plan of waypoints">
      <figcaption>
        {frame.title}; a square is {grid} m
        {here && oldOf(props.age) && `; the dot is ${oldOf(props.age)}`}
      </figcaption>
      <div
        className="drawn"
        role="application"
        aria-label={
          "Plan of waypoints: click to add one. By keys: arrows move the cross or the chosen " +
          "waypoint, Enter adds one at the cross, Delete removes it, Escape chooses none."
        }
        // biome-ignore lint/a11y/noNoninteractiveTabindex: it takes keys while it has the focus
        tabIndex={0}
        onPointerDown={onDown}
        onPointerMove={onMove}
        onPointerUp={onUp}
        onPointerCancel={() => {
          held.current = null;
        }}
        onKeyDown={onKey}
        onFocus={() => setFocused(true)}
        onBlur={() => setFocused(false)}
      >
        <svg ref={drawn} viewBox={`${left} ${top} ${size} ${size}`} aria-hidden="true">
          <Grid left={left} top={top} size={size} grid={grid} />
          <polyline className="been" strokeWidth={size / 300} points={pathOf(been)} />
          <polyline strokeWidth={size / 200} points={pathOf(line)} />
          {here && <circle className="here" cx={here.right} cy={-here.up} r={size / 60} />}
          {points.map(
            (point, at) =>
              point && (
                <g
                  // biome-ignore lint/suspicious/noArrayIndexKey: waypoints have no other name
                  key={at}
                  className={classOf(at, chosen, progress)}
                  transform={`translate(${point.right} ${-point.up}) scale(${size / 40})`}
                >
                  <circle data-at={at} r="1" />
                  <text data-at={at} y="0.35" fontSize="1" textAnchor="middle">
                    {at + 1}
                  </text>
                </g>
              ),
          )}
          {isFocused && chosen < 0 && (
            <path
              className="cross"
              strokeWidth={size / 200}
              d={`M${cursor.right - size / 30} ${-cursor.up}h${size / 15}M${cursor.right} ${-cursor.up - size / 30}v${size / 15}`}
            />
          )}
          <text x={left + size / 60} y={top + size / 20} fontSize={size / 25}>
            {frame.axes[0]} ↑ in m, {frame.axes[1]} → in m
          </text>
        </svg>
      </div>
      <button type="button" onClick={() => setView(fitting())}>
        Show all
      </button>
      <button type="button" aria-label="Zoom in" onClick={() => zoom(0.5)}>
        +
      </button>
      <button type="button" aria-label="Zoom out" onClick={() => zoom(2)}>
        −
      </button>
      {/* Always there: what comes and goes with the focus would move what is clicked next. */}
      <Quiet>
        {`The cross is at ${frame.axes[0]} ${cursor.up.toFixed(2)} m, ${frame.axes[1]} ${cursor.right.toFixed(2)} m.`}
      </Quiet>
    </figure>
  );
}

const pathOf = (points: Point[]) => points.map(({ up, right }) => `${right},${-up}`).join(" ");

function classOf(at: number, chosen: number, progress: Progress | undefined): string {
  const state =
    progress?.active === at + 1 ? " active" : progress?.isReached(at + 1) ? " reached" : "";
  return `waypoint${at === chosen ? " chosen" : ""}${state}`;
}

/** Lines with their metres at the left and the lower edge. */
function Grid({
  left,
  top,
  size,
  grid,
}: {
  left: number;
  top: number;
  size: number;
  grid: number;
}) {
  const steps = (from: number) =>
    Array.from({ length: Math.ceil(size / grid) + 1 }, (_, index) => index + Math.ceil(from / grid))
      .map((count) => count * grid)
      .filter((position) => position < from + size);
  const shown = (metres: number) => String(Number(metres.toPrecision(6)));
  return (
    <g className="grid" strokeWidth={size / 800}>
      {steps(left).map((right) => (
        <g key={right}>
          <path d={`M${right} ${top}v${size}`} />
          <text x={right + size / 200} y={top + size * 0.99} fontSize={size / 35}>
            {shown(right)}
          </text>
        </g>
      ))}
      {steps(top).map((down) => (
        <g key={down}>
          <path d={`M${left} ${down}h${size}`} />
          <text x={left + size / 200} y={down - size / 200} fontSize={size / 35}>
            {shown(-down)}
          </text>
        </g>
      ))}
    </g>
  );
}
