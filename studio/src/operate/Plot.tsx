import { useEffect, useRef, useState } from "react";
import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import { messageOf } from "../connection";
import { clock } from "../panels/base/parts";
import { ask, nameOf } from "./unit";

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
export function Plot({ series: { component, report, path }, seconds }: Props) {
  const title = `${path || "rate in Hz"} of ${report}`;
  const place = useRef<HTMLDivElement>(null);
  const [last, setLast] = useState("");
  useEffect(() => {
    const element = place.current;
    if (!element) return;
    const size = () => ({ width: Math.max(200, element.clientWidth), height: HEIGHT });
    const style = getComputedStyle(document.documentElement);
    // Asked at each drawing: the page may have turned dark since.
    const colour = (name: string) => () => style.getPropertyValue(name) || "#888";
    const axis = { stroke: colour("--ink"), grid: { stroke: colour("--faint") } };
    const times: uPlot.Axis = {
      values: (_, times) => times.map(clock),
    };
    // The clock of the server, of which the times are: that of the browser may be another.
    let now = 0;
    const range = (): [number, number] => [now - seconds, now];
    const plot = new uPlot(
      {
        ...size(),
        legend: { show: false },
        series: [{}, { stroke: colour("--chosen"), width: 1.5 }],
        axes: [
          { ...axis, ...times },
          { ...axis, size: 60 },
        ],
        scales: { x: { time: true, range } },
      },
      [[], []],
      element,
    );
    let isWanted = true;
    async function look() {
      try {
        const points = size().width * POINTS;
        const history = await ask("history", { component, report, path, seconds, points });
        if (!isWanted) return;
        now = history.epoch + history.now;
        plot.setData([history.times.map((time) => history.epoch + time), history.values]);
        const value = history.values.at(-1);
        const text = value === null ? "is no number" : value?.toPrecision(4);
        setLast(text === undefined ? "no values" : `last ${text}`);
      } catch (error) {
        if (isWanted) setLast(messageOf(error));
      }
    }
    void look();
    const timer = setInterval(() => void look(), LOOK_MS);
    const resized = new ResizeObserver(() => plot.setSize(size()));
    resized.observe(element);
    const dark = window.matchMedia("(prefers-color-scheme: dark)");
    const redraw = () => plot.redraw(false);
    dark.addEventListener("change", redraw);
    return () => {
      isWanted = false;
      clearInterval(timer);
      resized.disconnect();
      dark.removeEventListener("change", redraw);
      plot.destroy();
    };
  }, [component, report, path, seconds]);
  return (
    <figure aria-label={title}>
      <figcaption>
        {title}, {nameOf(component)}: <output>{last}</output>
      </figcaption>
      <div ref={place} />
    </figure>
  );
}
