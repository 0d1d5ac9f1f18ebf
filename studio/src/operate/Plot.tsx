import { useEffect, useRef, useState } from "react";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { messageOf } from "../actions";
import { ask } from "./unit";

export interface Series {
  component: string;
  report: string;
  /** Path of a number; empty for the rate. */
  path: string;
}

interface Props {
  series: Series;
  seconds: number;
}

const LOOK_MS = 1000;
const HEIGHT = 140;
/** Points for each pixel: the least and the greatest of a piece. */
const POINTS = 2;

/** A number over time; the server leaves out what a screen cannot show, and keeps peaks. */
export function Plot({ series, seconds }: Props) {
  const place = useRef<HTMLDivElement>(null);
  const [last, setLast] = useState("");
  const { component, report, path } = series;
  const title = path || "rate in Hz";
  useEffect(() => {
    const element = place.current;
    if (!element) return;
    const width = Math.max(200, element.clientWidth);
    const style = getComputedStyle(document.documentElement);
    const colour = (name: string) => style.getPropertyValue(name) || "#888";
    const axis = { stroke: colour("--ink"), grid: { stroke: colour("--faint") } };
    const plot = new uPlot(
      {
        width,
        height: HEIGHT,
        legend: { show: false },
        series: [{}, { label: title, stroke: colour("--chosen"), width: 1.5 }],
        axes: [axis, { ...axis, size: 60 }],
        scales: { x: { range: () => [Date.now() / 1000 - seconds, Date.now() / 1000] } },
      },
      [[], []],
      element,
    );
    let isWanted = true;
    async function look() {
      try {
        const points = width * POINTS;
        const found = await ask("history", { component, report, path, seconds, points });
        if (!isWanted) return;
        plot.setData([found.times, found.values]);
        const value = found.values.at(-1);
        setLast(value === undefined ? "no values" : `last ${value.toPrecision(4)}`);
      } catch (error) {
        if (isWanted) setLast(messageOf(error));
      }
    }
    void look();
    const timer = setInterval(() => void look(), LOOK_MS);
    return () => {
      isWanted = false;
      clearInterval(timer);
      plot.destroy();
    };
  }, [component, report, path, seconds, title]);
  return (
    <figure className="plot" aria-label={`${title} of ${report}`}>
      <figcaption>
        {title} of {report}, {component}: <output>{last}</output>
      </figcaption>
      <div ref={place} />
    </figure>
  );
}
