import { useCallback, useMemo } from "react";
import type uPlot from "uplot";
import { TimePlot } from "./TimePlot";
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

/** A number over time; the server leaves out what a screen cannot show, and keeps peaks. */
export function Plot({ series, seconds }: Props) {
  const { component, report, path } = series;
  const title = path || "rate in Hz";
  const lines = useMemo(() => [{ label: title, colour: "--chosen" }], [title]);
  const range = useCallback((): [number, number] => {
    const now = Date.now() / 1000;
    return [now - seconds, now];
  }, [seconds]);
  const look = useCallback(
    async (points: number): Promise<uPlot.AlignedData> => {
      const found = await ask("history", { component, report, path, seconds, points });
      return [found.times, found.values];
    },
    [component, report, path, seconds],
  );
  return (
    <TimePlot
      title={`${title} of ${report}`}
      caption={`${title} of ${report}, ${nameOf(component)}`}
      lines={lines}
      range={range}
      look={look}
      period={LOOK_MS}
      isClock
    />
  );
}
