import { useState } from "react";
import type { Component, HandoffRequest } from "./protocol";
import { ask, choose, commands, taking, tried, useUnit } from "./unit";

const SIGNS: Record<string, string> = { ok: "✔", warning: "▲", error: "✖" };

/** Who is there, who controls whom, and who asks for control. */
export function Components() {
  const state = useUnit((unit) => unit.state);
  const chosen = useUnit((unit) => unit.chosen);
  const components = state?.components ?? [];
  return (
    <section aria-label="Components">
      <table>
        <caption>Components</caption>
        <thead>
          <tr>
            <th scope="col">component</th>
            <th scope="col">level</th>
            <th scope="col">state</th>
            <th scope="col">controlled by</th>
          </tr>
        </thead>
        <tbody>
          {components.map((each) => (
            <tr key={each.id} aria-selected={each.id === chosen}>
              <th scope="row">
                <button
                  type="button"
                  className="link"
                  aria-pressed={each.id === chosen}
                  onClick={() => choose(each.id)}
                >
                  {each.name || each.id} <small className="quiet">{each.id}</small>
                </button>
              </th>
              <td title={each.reason}>
                <span aria-hidden="true">{SIGNS[each.level] ?? "◌"}</span> {each.level}
              </td>
              <td>{each.state ?? "–"}</td>
              <td>{controllerOf(each, state?.own ?? "")}</td>
            </tr>
          ))}
        </tbody>
      </table>
      <Requests />
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
  const held = useUnit((unit) => unit.state?.holds.find((each) => each.component === component));
  const [authority, setAuthority] = useState("");
  const [reason, setReason] = useState("");
  if (!mayCommand) return null;
  const number = Number(authority);
  const isGood = authority !== "" && Number.isInteger(number) && number >= 0 && number <= 255;
  if (held) {
    const off = !isOurs;
    return (
      <fieldset className="control">
        <legend>{component} is controlled</legend>
        <button type="button" disabled={off} onClick={() => void tried("resume", { component })}>
          Resume
        </button>
        <button type="button" disabled={off} onClick={() => void tried("standby", { component })}>
          Standby
        </button>
        <button type="button" disabled={off} onClick={() => void tried("release", { component })}>
          Release control
        </button>
        <button type="button" onClick={() => void tried("clear", { component })}>
          Clear emergency
        </button>
      </fieldset>
    );
  }
  const isFree = commander === null || isOurs;
  return (
    <fieldset className="control">
      <legend>Control of {component}</legend>
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
      <button
        type="button"
        className="primary"
        disabled={!isFree || !isGood}
        onClick={() => void taking(ask("take", { component, authority: number }))}
      >
        Take control
      </button>
      <label>
        or ask who has it, because
        <input value={reason} onChange={(event) => setReason(event.currentTarget.value)} />
      </label>
      <button
        type="button"
        disabled={!isFree || !isGood || reason.trim() === ""}
        onClick={() => void taking(ask("handoff", { component, authority: number, reason }))}
      >
        Ask for control
      </button>
      <button type="button" onClick={() => void tried("clear", { component })}>
        Clear emergency
      </button>
      {!isFree && <span className="quiet">{commander?.name} commands.</span>}
    </fieldset>
  );
}

/** Who asks for control of what is controlled here; a person decides. */
function Requests() {
  const requests = useUnit((unit) => unit.state?.requests ?? null);
  if (!requests?.length) return null;
  return (
    <ul className="requests" aria-label="Requests for control">
      {requests.map((each) => (
        <Request key={`${each.component} ${each.number}`} request={each} />
      ))}
    </ul>
  );
}

function Request({ request }: { request: HandoffRequest }) {
  const isOurs = useUnit(commands);
  const { component, number } = request;
  const decide = (decision: "grant" | "deny" | "defer") =>
    void tried("decide", { component, number, decision });
  return (
    <li role="alert">
      {request.client} asks for control of {component} with authority {request.authority}:{" "}
      {request.explanation || "without a reason"}
      <button type="button" disabled={!isOurs} onClick={() => decide("grant")}>
        Grant
      </button>
      <button type="button" disabled={!isOurs} onClick={() => decide("deny")}>
        Deny
      </button>
      <button type="button" disabled={!isOurs} onClick={() => decide("defer")}>
        Defer
      </button>
    </li>
  );
}
