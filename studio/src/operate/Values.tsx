import { lazy, Suspense, useEffect, useState } from "react";
import { messageOf } from "../connection";
import { Quiet } from "../panels/base/parts";
import { Age } from "./Age";
import { Plan } from "./Plan";
import { Plot, type Series } from "./Plot";
import type { Values } from "./protocol";
import { ask, nameOf as named, tell, tried, useUnit } from "./unit";

const Media = lazy(() => import("./Media"));

const LOOK_MS = 500;
/** A report that is asked for by sensors, and one that tells where streams are. */
const PICTURE = "StillImageData";
const ENDPOINTS = "ReportDigitalResourceEndpoint";
const RATES = ["every change", "1", "2", "5", "10", "25"];
/** Seconds without a report after which its values are told to be old. */
const OLD_S = 3;
const SPANS: [string, number][] = [
  ["1 minute", 60],
  ["5 minutes", 300],
  ["15 minutes", 900],
];

/** Reports that are watched: their last values, plots of numbers, and a plan of positions. */
export function ValuesPanel() {
  const component = useUnit((unit) => unit.chosen);
  const [values, setValues] = useState<Values[]>([]);
  const [plotted, setPlotted] = useState<Series[]>([]);
  const [span, setSpan] = useState(60);
  useEffect(() => {
    let isWanted = true;
    const timer = setInterval(() => {
      ask("values", {}).then(
        (found) => isWanted && setValues(found.values),
        () => undefined,
      );
    }, LOOK_MS);
    return () => {
      isWanted = false;
      clearInterval(timer);
    };
  }, []);
  const toggle = (series: Series) =>
    setPlotted((before) =>
      before.some((each) => isSame(each, series))
        ? before.filter((each) => !isSame(each, series))
        : [...before, series],
    );
  return (
    <>
      <section className="values" aria-label="Values">
        <h2>Values</h2>
        {component && <Watch key={component} component={component} />}
        {values.map((each) => (
          <Report
            key={`${each.component} ${each.report}`}
            values={each}
            plotted={plotted}
            onPlot={toggle}
          />
        ))}
      </section>
      <section className="plots" aria-label="Plots">
        <h2>
          Plots of{" "}
          <select
            aria-label="Plots of"
            value={span}
            onChange={(event) => setSpan(Number(event.currentTarget.value))}
          >
            {SPANS.map(([name, seconds]) => (
              <option key={seconds} value={seconds}>
                {name}
              </option>
            ))}
          </select>
        </h2>
        {plotted.map((each) => (
          <Plot key={nameOf(each)} series={each} seconds={span} />
        ))}
        <Plan values={values} />
      </section>
    </>
  );
}

const isSame = (one: Series, other: Series) => nameOf(one) === nameOf(other);
const nameOf = ({ component, report, path }: Series) => `${component} ${report} ${path}`;

function Watch({ component }: { component: string }) {
  const [reports, setReports] = useState<string[]>([]);
  const [report, setReport] = useState("");
  const [rate, setRate] = useState("");
  const [sensor, setSensor] = useState("1");
  useEffect(() => {
    let isWanted = true;
    ask("messages", { component }).then(
      (found) => isWanted && setReports(found.reports.map((each) => each.name)),
      (error: unknown) => isWanted && tell(messageOf(error), true),
    );
    return () => {
      isWanted = false;
    };
  }, [component]);
  return (
    <div className="watch">
      <label>
        Report of {component}
        <select
          aria-label={`Report of ${component}`}
          value={report}
          onChange={(event) => setReport(event.currentTarget.value)}
        >
          <option value="">choose…</option>
          {reports.map((each) => (
            <option key={each}>{each}</option>
          ))}
        </select>
      </label>
      <label>
        Hz
        <select
          aria-label="Hz"
          value={rate}
          onChange={(event) => setRate(event.currentTarget.value)}
        >
          {RATES.map((each) => (
            <option key={each} value={each === RATES[0] ? "" : each}>
              {each}
            </option>
          ))}
        </select>
      </label>
      {report === PICTURE && (
        <label>
          Sensor
          <input
            inputMode="numeric"
            size={5}
            value={sensor}
            onChange={(event) => setSensor(event.currentTarget.value)}
          />
        </label>
      )}
      <button
        type="button"
        disabled={report === ""}
        onClick={() =>
          void tried("watch", {
            component,
            report,
            rate: rate === "" ? null : Number(rate),
            fields: report === PICTURE ? pictureOf(Number(sensor)) : null,
          })
        }
      >
        Watch
      </button>
    </div>
  );
}

/** The query of the picture of one sensor, with its time (AS6060). */
const pictureOf = (sensor: number) => ({
  QueryStillImageDataList: [
    { SensorID: sensor, ReportCoordinateSystem: 0, QueryPresenceVector: 1 },
  ],
});

interface ReportProps {
  values: Values;
  plotted: Series[];
  onPlot(series: Series): void;
}

function Report({ values, plotted, onPlot }: ReportProps) {
  const { component, report, age } = values;
  const silence = useUnit((unit) => unit.silence);
  const isOld = age === null || age + silence > OLD_S;
  const button = (path: string, what: string) => {
    const series = { component, report, path };
    return (
      <button
        type="button"
        aria-pressed={plotted.some((each) => isSame(each, series))}
        aria-label={`Plot ${what} of ${report}`}
        onClick={() => onPlot(series)}
      >
        plot
      </button>
    );
  };
  return (
    <div className="report">
      <table className={isOld ? "old" : ""}>
        <caption>
          {report} of {named(component)} <Age seconds={age} limit={OLD_S} />
          <small>, {values.count} in all</small> {button("", "the rate")}{" "}
          <button type="button" onClick={() => void tried("unwatch", { component, report })}>
            Watch no more
          </button>
        </caption>
        <tbody>
          {values.fields.map(([path, text]) => (
            <tr key={path}>
              <th scope="row">{path}</th>
              <td>{text}</td>
              <td>{values.numbers.includes(path) && button(path, path)}</td>
            </tr>
          ))}
          {values.fields.length === 0 && (
            <tr>
              <td>
                <Quiet>No values.</Quiet>
              </td>
            </tr>
          )}
        </tbody>
      </table>
      {(values.pictures.length > 0 || report === ENDPOINTS) && (
        <Suspense fallback={null}>
          <Media values={values} />
        </Suspense>
      )}
    </div>
  );
}
