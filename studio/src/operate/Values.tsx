import { lazy, Suspense, useState } from "react";
import { usePolled } from "../answers";
import { CHOOSE, Quiet, Select } from "../panels/base/parts";
import { Age, OLD_S } from "./Age";
import { Plan } from "./Plan";
import { Plot, type Series } from "./Plot";
import type { Values } from "./protocol";
import { ask, nameOf as named, tried, useAnswer, useUnit } from "./unit";

const Media = lazy(() => import("./Media"));

const LOOK_MS = 500;
/** A report that is asked for by sensors, and one that tells where streams are. */
const PICTURE = "StillImageData";
const ENDPOINTS = "ReportDigitalResourceEndpoint";
const RATES = ["1", "2", "5", "10", "25"];
const SPANS: [number, string][] = [
  [60, "1 minute"],
  [300, "5 minutes"],
  [900, "15 minutes"],
];
const look = () => ask("values", {});

/** Reports that are watched: their last values, plots of numbers, and a plan of positions. */
export function ValuesPanel() {
  const component = useUnit((unit) => unit.chosen);
  const values = usePolled(look, LOOK_MS)?.values ?? [];
  const [plotted, setPlotted] = useState<Series[]>([]);
  const [span, setSpan] = useState(60);
  const toggle = (series: Series) =>
    setPlotted((before) =>
      before.some((other) => isSame(other, series))
        ? before.filter((other) => !isSame(other, series))
        : [...before, series],
    );
  return (
    <>
      <section className="values" aria-label="Values">
        <h2>Values</h2>
        {component && <Watch key={component} component={component} />}
        {values.map((value) => (
          <Report
            key={`${value.component} ${value.report}`}
            values={value}
            plotted={plotted}
            onPlot={toggle}
          />
        ))}
      </section>
      <section className="plots" aria-label="Plots">
        <h2>
          Plots of{" "}
          <Select
            label="Plots of"
            value={span}
            options={SPANS}
            onChoose={(seconds) => setSpan(Number(seconds))}
          />
        </h2>
        {plotted.map((series) => (
          <Plot key={nameOf(series)} series={series} seconds={span} />
        ))}
        <Plan values={values} />
      </section>
    </>
  );
}

const isSame = (one: Series, other: Series) => nameOf(one) === nameOf(other);
const nameOf = ({ component, report, path }: Series) => `${component} ${report} ${path}`;

function Watch({ component }: { component: string }) {
  const learnt = useUnit((unit) => unit.learnt);
  const reports = useAnswer("messages", { component }, learnt).value?.reports ?? [];
  const [report, setReport] = useState("");
  const [rate, setRate] = useState("");
  const [sensor, setSensor] = useState("1");
  return (
    <div className="bar">
      <label>
        Report of {component}
        <Select
          label={`Report of ${component}`}
          value={report}
          options={[CHOOSE, ...reports.map(({ name }) => [name, name] as const)]}
          onChoose={setReport}
        />
      </label>
      <label>
        Hz
        <Select
          label="Hz"
          value={rate}
          options={[["", "every change"], ...RATES.map((rate) => [rate, rate] as const)]}
          onChoose={setRate}
        />
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
        disabled={report === "" || (report === PICTURE && sensor.trim() === "")}
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
        aria-pressed={plotted.some((other) => isSame(other, series))}
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
        </tbody>
      </table>
      {values.fields.length === 0 && <Quiet>No values.</Quiet>}
      {(values.pictures.length > 0 || report === ENDPOINTS) && (
        <Suspense fallback={null}>
          <Media values={values} />
        </Suspense>
      )}
    </div>
  );
}
