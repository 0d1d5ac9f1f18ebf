import { lazy, type ReactNode, Suspense, useEffect } from "react";
import { Canvas } from "./canvas/Canvas";
import { Dialogs } from "./dialogs/Dialogs";
import { Banners } from "./header/Banners";
import { Header } from "./header/Header";
import { onPaste, onShortcut } from "./keyboard/shortcuts";
import { PropertyForm } from "./panels/form/PropertyForm";
import { Generate } from "./panels/generate/Generate";
import { Live } from "./panels/live/Live";
import { Log } from "./panels/log/Log";
import { MapEditor } from "./panels/map/MapEditor";
import { Outline } from "./panels/outline/Outline";
import { Palette } from "./panels/palette/Palette";
import { Problems } from "./panels/problems/Problems";
import { Source } from "./panels/source/Source";
import { Stepping } from "./panels/stepping/Stepping";
import { asProperties, Splitter, useSizes } from "./Splitter";
import { type BottomTab, type MiddleTab, update, useStudio } from "./store";
import { Tabs } from "./Tabs";
import { TableView } from "./table/TableView";
import { ViewBar } from "./views/ViewBar";

const Recording = lazy(() => import("./panels/recording/Recording"));

/** The page: what there is (left), the diagram (middle), what is chosen (right), verdicts (bottom). */
export function App() {
  useEffect(() => {
    document.addEventListener("keydown", onShortcut);
    document.addEventListener("paste", onPaste);
    return () => {
      document.removeEventListener("keydown", onShortcut);
      document.removeEventListener("paste", onPaste);
    };
  }, []);
  const left = useStudio((studio) => studio.left);
  const right = useStudio((studio) => studio.right);
  const [sizes, resize] = useSizes();
  const fold = () => resize({ isFolded: !sizes.isFolded });
  return (
    <div className="studio" style={asProperties(sizes, right)}>
      <Header />
      <Banners />
      <aside className="left" aria-label="What there is">
        <Tabs
          label="Show of what there is"
          tabs={LEFT}
          chosen={left}
          onChoose={(tab) => update({ left: tab })}
        >
          {left === "outline" ? <Outline /> : <Palette />}
        </Tabs>
        <Splitter
          side="left"
          label="Width of the palette"
          size={sizes.left}
          onSize={(left) => resize({ left })}
        />
      </aside>
      <Middle />
      <aside className="right" aria-label="What is chosen">
        <Tabs
          label="Show of what is chosen"
          tabs={RIGHT}
          chosen={right}
          onChoose={(tab) => update({ right: tab })}
        >
          {right === "form" ? <PropertyForm /> : <Source />}
        </Tabs>
        <Splitter
          side={right}
          label="Width of the properties"
          size={sizes[right]}
          onSize={(size) => resize({ [right]: size })}
        />
      </aside>
      <Bottom isFolded={sizes.isFolded} onFold={fold}>
        <Splitter
          side="bottom"
          label="Height of the lower panel"
          size={sizes.bottom}
          onSize={(bottom) => resize({ bottom, isFolded: false })}
          onFold={fold}
        />
      </Bottom>
      <Dialogs />
      <Said />
    </div>
  );
}

function Middle() {
  const chosen = useStudio((studio) => studio.middle);
  const isMap = useStudio((studio) => studio.view.startsWith("map:"));
  const tabs: [MiddleTab, string][] = [
    ["diagram", "Diagram"],
    ["table", "Table"],
  ];
  // A map has more members than its diagram shows, and can be tried.
  if (isMap) tabs.push(["members", "All members, and try it"]);
  const middle = chosen === "members" && !isMap ? "diagram" : chosen;
  return (
    <main className="middle">
      <ViewBar />
      <Tabs label="View as" tabs={tabs} chosen={middle} onChoose={(tab) => update({ middle: tab })}>
        {middle === "table" ? <TableView /> : middle === "members" ? <MapEditor /> : <Canvas />}
      </Tabs>
    </main>
  );
}

const LEFT = [
  ["palette", "Palette"],
  ["outline", "Outline"],
] as const;
const RIGHT = [
  ["form", "Properties"],
  ["source", "Source"],
] as const;

interface BottomProps {
  isFolded: boolean;
  onFold: () => void;
  children: ReactNode;
}

function Bottom({ isFolded, onFold, children }: BottomProps) {
  const chosen = useStudio((studio) => studio.bottom);
  const isMachine = useStudio((studio) => studio.view.startsWith("machine:"));
  const tabs: [BottomTab, string][] = [
    ["problems", useProblemsTitle()],
    ["generate", "Generate"],
    ["live", "Live"],
    ["recording", "Recording"],
    ["log", "History"],
  ];
  if (isMachine) tabs.splice(1, 0, ["step", "Step"]);
  const bottom = chosen === "step" && !isMachine ? "problems" : chosen;
  const panels = {
    problems: Problems,
    generate: Generate,
    live: Live,
    recording: Recording,
    step: Stepping,
    log: Log,
  };
  const Panel = panels[bottom];
  return (
    <section className="bottom" aria-label="Verdicts and work">
      <button
        type="button"
        className="fold"
        aria-expanded={!isFolded}
        aria-label="Lower panel"
        onClick={onFold}
      >
        {isFolded ? "▴" : "▾"}
      </button>
      <Tabs
        label="Show"
        tabs={tabs}
        chosen={bottom}
        onChoose={(tab) => {
          update({ bottom: tab });
          if (isFolded) onFold();
        }}
      >
        <Suspense>
          <Panel />
        </Suspense>
      </Tabs>
      {children}
    </section>
  );
}

/** What is wrong can be seen while another tab is open, or none. */
function useProblemsTitle(): string {
  const count = useStudio(
    (studio) =>
      studio.problems?.problems.filter((problem) => problem.severity === "error").length ?? 0,
  );
  const isUnchecked = useStudio((studio) => Boolean(studio.problems?.fault));
  if (count === 0 && isUnchecked) return "Problems (× not checked)";
  return count ? `Problems (× ${count})` : "Problems";
}

/** What was just done, spoken politely; faults at once. */
function Said() {
  const said = useStudio((studio) => studio.said);
  return (
    <footer className="said">
      <output aria-live="polite">{said.isError ? "" : said.text}</output>
      <span role="alert">{said.isError ? said.text : ""}</span>
    </footer>
  );
}
