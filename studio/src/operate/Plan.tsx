import { useCallback } from "react";
import { usePolled } from "../answers";
import { OLD_S } from "./Age";
import { around, barOf, FRAMES, type Frame, type Place, paired } from "./plan";
import type { Values } from "./protocol";
import { ask } from "./unit";

const LOOK_MS = 1000;
const SECONDS = 120;
const POINTS = 2000;
const LEAST_M = 10;

interface Track {
  component: string;
  values: Place[];
  /** Seconds since the last of them. */
  age: number;
}

/** How long ago a component told where it is, where that is too long. */
export const oldOf = (age: number): string => (age > OLD_S ? `✝ ${Math.round(age)} s old` : "");

/** Where the components are whose poses are watched, and where they were. */
export function Plan({ values }: { values: Values[] }) {
  return FRAMES.map((frame) => {
    const components = values
      .filter((value) => value.report === frame.report)
      .map((value) => value.component);
    if (components.length === 0) return null;
    return <FramePlan key={frame.report} frame={frame} components={components} />;
  });
}

function FramePlan({ frame, components }: { frame: Frame; components: string[] }) {
  const names = components.join(" ");
  const look = useCallback(
    () => Promise.all(names.split(" ").map((name) => trackOf(frame, name))),
    [frame, names],
  );
  const tracks = (usePolled(look, LOOK_MS) ?? []).filter((track) => track.values.length > 0);
  const origin = tracks[0]?.values[0];
  if (!origin) return null;
  const placed = tracks.map(({ component, values, age }) => ({
    component,
    text: [component, oldOf(age)].join(" ").trim(),
    points: values.map(([first, second]) => frame.pointOf(first, second, origin)),
  }));
  const [left, top, size] = around(
    placed.flatMap((track) => track.points),
    LEAST_M,
  );
  const bar = barOf(size);
  return (
    <figure className="plan" aria-label={`Plan of ${frame.report}`}>
      <figcaption>
        {frame.title}; the bar is {bar} m
      </figcaption>
      <svg viewBox={`${left} ${top} ${size} ${size}`} role="img" aria-label={textOf(placed)}>
        <path
          className="bar"
          strokeWidth={size / 100}
          d={`M${left + size / 20} ${top + size * 0.95}h${bar}`}
        />
        {placed.map(({ component, text, points }) => {
          const last = points.at(-1);
          return (
            <g key={component}>
              <polyline
                strokeWidth={size / 200}
                points={points.map((point) => `${point.right},${-point.up}`).join(" ")}
              />
              <circle cx={last?.right} cy={-(last?.up ?? 0)} r={size / 60} />
              <text x={(last?.right ?? 0) + size / 40} y={-(last?.up ?? 0)} fontSize={size / 25}>
                {text}
              </text>
            </g>
          );
        })}
      </svg>
    </figure>
  );
}

/** Where a component was in the last minutes. */
export async function trackOf({ report, paths }: Frame, component: string): Promise<Track> {
  const asked = { component, report, seconds: SECONDS, points: POINTS };
  const [first, second] = await Promise.all(
    paths.map((path) => ask("history", { ...asked, path })),
  );
  const values = first && second ? paired(first, second) : [];
  return { component, values, age: (first?.now ?? 0) - (first?.times.at(-1) ?? 0) };
}

/** The same in words. */
function textOf(placed: { text: string; points: { up: number; right: number }[] }[]): string {
  const texts = placed.map(({ text, points }) => {
    const last = points.at(-1);
    return `${text}: ${last?.up.toFixed(1)} m up, ${last?.right.toFixed(1)} m right`;
  });
  return texts.join("; ");
}
