import { type ReactNode, useEffect, useRef, useState } from "react";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { messageOf } from "../connection";

const HEIGHT = 140;
/** Points for each pixel: the least and the greatest of a piece. */
const POINTS = 2;

export interface Line {
  label: string;
  /** Name of a colour of the page. */
  colour: string;
}

interface Props {
  title: string;
  caption: ReactNode;
  lines: readonly Line[];
  /** From when to when. */
  range: () => [number, number];
  /** Returns the values at so many points at most. */
  look: (points: number) => Promise<uPlot.AlignedData>;
  /** Milliseconds from one look to the next; it looks once without. */
  period?: number;
  /** Whether times are those of the clock, and not seconds since a beginning. */
  isClock?: boolean;
}

/** Numbers over time. Its functions and lines stay the same from one drawing to the next. */
export function TimePlot({ title, caption, lines, range, look, period = 0, isClock }: Props) {
  const place = useRef<HTMLDivElement>(null);
  const [last, setLast] = useState("");
  useEffect(() => {
    const element = place.current;
    if (!element) return;
    const roomy = () => Math.max(200, element.clientWidth);
    const style = getComputedStyle(document.documentElement);
    const colour = (name: string) => style.getPropertyValue(name) || "#888";
    // Asked at each drawing: the page may have turned dark since.
    const axis = { stroke: () => colour("--ink"), grid: { stroke: () => colour("--faint") } };
    const clock: uPlot.Axis = {
      values: (_, times) => times.map((at) => new Date(1000 * at).toTimeString().slice(0, 8)),
    };
    const plot = new uPlot(
      {
        width: roomy(),
        height: HEIGHT,
        legend: { show: false },
        series: [
          {},
          ...lines.map((each) => ({
            label: each.label,
            stroke: () => colour(each.colour),
            width: 1.5,
            spanGaps: lines.length > 1,
          })),
        ],
        axes: [isClock ? { ...axis, ...clock } : axis, { ...axis, size: 60 }],
        scales: { x: { time: Boolean(isClock), range } },
      },
      [[], ...lines.map(() => [])] as unknown as uPlot.AlignedData,
      element,
    );
    let isWanted = true;
    async function show() {
      try {
        const found = await look(roomy() * POINTS);
        if (!isWanted) return;
        plot.setData(found);
        const told = found.slice(1).flatMap((line) => {
          const value = Array.from<number | null | undefined>(line).findLast(
            (each) => each != null,
          );
          return value == null ? [] : [value.toPrecision(4)];
        });
        setLast(told.length ? `last ${told.join(", ")}` : "no values");
      } catch (error) {
        if (isWanted) setLast(messageOf(error));
      }
    }
    void show();
    const resized = new ResizeObserver(() => plot.setSize({ width: roomy(), height: HEIGHT }));
    resized.observe(element);
    const dark = window.matchMedia("(prefers-color-scheme: dark)");
    const redraw = () => plot.redraw(false);
    dark.addEventListener("change", redraw);
    const timer = period ? setInterval(() => void show(), period) : undefined;
    return () => {
      isWanted = false;
      clearInterval(timer);
      resized.disconnect();
      dark.removeEventListener("change", redraw);
      plot.destroy();
    };
  }, [lines, range, look, period, isClock]);
  return (
    <figure className="plot" aria-label={title}>
      <figcaption>
        {caption}: <output>{last}</output>
      </figcaption>
      <div ref={place} />
    </figure>
  );
}
