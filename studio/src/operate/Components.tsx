import { useState } from "react";
import { Head, Level } from "../panels/base/parts";
import { Age } from "./Age";
import type { Component } from "./protocol";
import { useStill } from "./still";
import { ask, choose, commands, nameOf, taking, tried, useUnit } from "./unit";

/** Seconds after which who says nothing counts as gone. */
const SILENCE_S = 5;

/** Who is there, who controls whom, and who asks for control. */
export function Components() {
  const state = useUnit((unit) => unit.state);
  const chosen = useUnit((unit) => unit.chosen);
  const components = useUnit((unit) => unit.components);
  const { shown, waiting, isGone, hand } = useStill(components, (component) => component.id);
  return (
    <section className="components" aria-label="Components">
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: it scrolls by keys */}
      <div className="components-table" tabIndex={0} {...hand}>
        <table>
          <caption>Components{waiting > 0 && `, ${waiting} newer`}</caption>
          <Head columns={["component", "level", "state", "heard", "controlled by"]} />
          <tbody>
            {shown.map((component) => (
              <tr
                key={component.id}
                className={isGone(component) ? "gone" : ""}
                aria-selected={component.id === chosen}
              >
                <th scope="row">
                  <button
                    type="button"
                    className="link"
                    aria-pressed={component.id === chosen}
                    onClick={() => choose(component.id)}
                  >
                    {component.name || component.id} <small className="quiet">{component.id}</small>
                  </button>
                </th>
                <td title={component.reason}>
                  <Level level={component.level} />
                </td>
                <td>{component.state ?? "–"}</td>
                <td>
                  <Age seconds={state?.ages[component.id] ?? null} limit={SILENCE_S} />
                </td>
                <td>{controllerOf(component, state?.own ?? "")}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      {chosen && <Control key={chosen} component={chosen} />}
    </section>
  );
}

function controllerOf({ controller, authority }: Component, own: string): string {
  if (!controller) return "–";
  const who = controller === own ? "this unit" : controller;
  return authority === null ? who : `${who}, authority ${authority}`;
}

/** Take and release control of a component, and bring it to Ready. */
function Control({ component }: { component: string }) {
  const mayCommand = useUnit((unit) => unit.mayCommand);
  const isOurs = useUnit(commands);
  const commander = useUnit((unit) => unit.state?.commander ?? null);
  const held = useUnit((unit) => unit.state?.holds.find((hold) => hold.component === component));
  const [authority, setAuthority] = useState("");
  const [reason, setReason] = useState("");
  if (!mayCommand) return null;
  const number = Number(authority);
  const isGood =
    authority.trim() !== "" && Number.isInteger(number) && number >= 0 && number <= 255;
  const isFree = !held && (commander === null || isOurs);
  const why = held
    ? ""
    : !isFree
      ? `${commander?.name} commands.`
      : isGood
        ? ""
        : "Say an authority first.";
  const button = (label: string, off: boolean, work: () => void) => (
    <button type="button" disabled={off} onClick={work}>
      {label}
    </button>
  );
  // All of it stays in its place, whether control is had or lost meanwhile.
  return (
    <fieldset className="bar">
      <legend>
        {nameOf(component)} {held ? "is controlled" : "is not controlled here"}
      </legend>
      <label>
        Authority, 0 .. 255
        <input
          inputMode="numeric"
          size={4}
          value={authority}
          aria-invalid={authority !== "" && !isGood}
          onChange={(event) => setAuthority(event.currentTarget.value)}
        />
      </label>
      {button(
        "Take control",
        !isFree || !isGood,
        () => void taking(ask("take", { component, authority: number })),
      )}
      {button("Resume", !held || !isOurs, () => void tried("resume", { component }))}
      {button("Standby", !held || !isOurs, () => void tried("standby", { component }))}
      {button("Release control", !held || !isOurs, () => void tried("release", { component }))}
      {button("Clear emergency", false, () => void tried("clear", { component }))}
      <label>
        or ask who has it, because
        <input value={reason} onChange={(event) => setReason(event.currentTarget.value)} />
      </label>
      {button(
        "Ask for control",
        !isFree || !isGood || reason.trim() === "",
        () => void taking(ask("handoff", { component, authority: number, reason })),
      )}
      <p className="quiet one-line">{why}</p>
    </fieldset>
  );
}
