import { type DragEvent, type KeyboardEvent, useEffect, useId, useRef, useState } from "react";
import { ask, change, DRAGGED, idle } from "../../actions";
import { useOnceReady, useSettled, useTrying } from "../../answers";
import { useListKeys } from "../../keyboard/useListKeys";
import type { PaletteGroup, PaletteItem, Ref } from "../../protocol";
import { useRevision, useStudio } from "../../store";
import { Fault, Quiet } from "../base/parts";
import { useAnswer } from "../base/useAnswer";
import { type Recent, recent, remember } from "./recent";

const GROUPS: PaletteGroup[] = ["elements", "components", "services", "ros types", "ready maps"];
const PAUSE_MS = 80;

interface Offer {
  item: Recent & Partial<PaletteItem>;
  group: string;
}

/**
 * What can be added: what fits the chosen element or the view first, then what the system takes. It is searched
 * as one types, dragged to the diagram, or added by Enter.
 */
export function Palette() {
  const file = useStudio((state) => state.file);
  const onto = useStudio((state) => state.chosen || (state.graph?.element ?? ""));
  const revision = useRevision();
  const [typed, setTyped] = useState("");
  const view = useStudio((state) => state.view && `${state.file} ${state.view}`);
  const seen = useRef(view);
  useEffect(() => {
    // What was searched for one view is not for another one; it may be typed before one is there.
    if (seen.current && seen.current !== view) setTyped("");
    seen.current = view;
  }, [view]);
  const query = useSettled(typed.trim(), PAUSE_MS);
  const { value, error } = useAnswer("palette", file ? { file, query, onto } : null, revision);
  const [kept, setKept] = useState(() => recent(localStorage));
  const [fault, attempt] = useTrying();
  const list = useId();

  const held = useHeld(value?.items);
  const items = (file && held) || [];
  const offers: Offer[] = [
    ...headed(items.filter((item) => item.onto)),
    ...(file && query === "" ? kept.map((item) => ({ item, group: "recently used" })) : []),
    ...headed(items.filter((item) => !item.onto)),
  ];
  const keys = useListKeys(offers.length, (at) => {
    const offer = offers[at];
    if (offer) void add(offer.item);
  });
  const { active } = keys;
  // What is still shown of an older question is not added.
  const isFound = value !== null && query === typed.trim();
  const addFirst = useOnceReady(isFound, () => offers[0] && void add(offers[0].item));

  const add = (item: Offer["item"]) =>
    attempt(async () => {
      const seen = revision;
      await idle();
      const isNow = item.commands && useStudio.getState().project?.revision === seen;
      const whole = isNow ? (item as PaletteItem) : await lookUp(file, item, onto);
      const base = isNow ? value?.revision : undefined;
      await change(whole.commands, whole.label_of_edit, base);
      setKept(remember(localStorage, whole));
    });

  function onKeyDown(event: KeyboardEvent) {
    if (event.key === "Enter" && !isFound) return addFirst(true);
    if (keys.onKey(event) || event.key !== "Escape" || typed === "") return;
    event.stopPropagation();
    setTyped("");
  }

  return (
    <section className="palette" aria-label="Palette">
      <input
        type="search"
        role="combobox"
        aria-label="Search what can be added"
        aria-expanded={offers.length > 0}
        aria-controls={list}
        aria-autocomplete="list"
        aria-activedescendant={offers.length > 0 ? `${list}-${active}` : undefined}
        placeholder="Search: service, type, map…"
        autoComplete="off"
        spellCheck="false"
        value={typed}
        onChange={(event) => {
          setTyped(event.currentTarget.value);
          keys.setActive(0);
          addFirst(false);
        }}
        onKeyDown={onKeyDown}
      />
      <Fault>{fault || error}</Fault>
      <div id={list} role="listbox" aria-label="What can be added" className="offers">
        {offers.map((offer, index) => (
          <Row
            key={`${offer.group} ${offer.item.id}`}
            id={`${list}-${index}`}
            offer={offer}
            isFirst={offers[index - 1]?.group !== offer.group}
            isActive={index === active}
            onPoint={() => keys.setActive(index)}
            onAdd={() => add(offer.item)}
          />
        ))}
      </div>
      {value && offers.length === 0 && <Quiet>Nothing has this name.</Quiet>}
      <Quiet>Drag to the diagram, or choose with ↑ ↓ and press Enter to add.</Quiet>
    </section>
  );
}

/** The last value that there was: what is shown stays until the next one has come. */
function useHeld<T>(value: T | undefined): T | undefined {
  const [held, setHeld] = useState(value);
  if (value !== undefined && value !== held) setHeld(value);
  return value ?? held;
}

/** Items under the heads of their groups, which say on what they go. */
function headed(items: PaletteItem[]): Offer[] {
  return GROUPS.flatMap((group) =>
    items
      .filter((item) => item.group === group)
      .map((item) => ({ item, group: item.onto ? `${group} on ${item.onto}` : group })),
  );
}

interface RowProps {
  id: string;
  offer: Offer;
  isFirst: boolean;
  isActive: boolean;
  onPoint: () => void;
  onAdd: () => void;
}

function Row({ id, offer: { item, group }, isFirst, isActive, onPoint, onAdd }: RowProps) {
  function onDragStart(event: DragEvent) {
    event.dataTransfer.effectAllowed = "copy";
    event.dataTransfer.setData(DRAGGED, JSON.stringify(item));
    event.dataTransfer.setData("text/plain", item.label);
  }

  return (
    <>
      {isFirst && <h4 role="presentation">{group}</h4>}
      {/* biome-ignore lint/a11y/useFocusableInteractive: the focus stays in the input, which names the active one */}
      {/* biome-ignore lint/a11y/useKeyWithClickEvents: keys are those of the input */}
      <div
        id={id}
        role="option"
        aria-selected={isActive}
        className="offer"
        draggable={item.commands !== undefined}
        title={item.documentation}
        ref={(element) => {
          if (isActive && element) scrollInList(element);
        }}
        onDragStart={onDragStart}
        onClick={onPoint}
        onDoubleClick={onAdd}
      >
        <span className="offer-label">{item.label}</span>
        {item.note && <small className="quiet">{item.note}</small>}
        {isActive && item.documentation && (
          <small className="documentation">{item.documentation}</small>
        )}
        {isActive && (
          // No button: an option has nothing in it that takes keys of its own.
          <span className="add" aria-hidden="true" onClick={onAdd}>
            Add
          </span>
        )}
      </div>
    </>
  );
}

/** Brings an offer into the sight of its list; the page around it stays where it is. */
function scrollInList(element: HTMLElement) {
  const list = element.parentElement;
  if (!list) return;
  const [top, bottom] = [
    element.offsetTop - list.offsetTop,
    element.offsetTop - list.offsetTop + element.offsetHeight,
  ];
  if (top < list.scrollTop) list.scrollTop = top;
  else if (bottom > list.scrollTop + list.clientHeight) list.scrollTop = bottom - list.clientHeight;
}

async function lookUp(file: string, wanted: Recent, onto: Ref): Promise<PaletteItem> {
  const { items } = await ask("palette", { file, query: wanted.label, onto });
  const choice = items.find((item) => item.id === wanted.id);
  if (!choice) throw new Error(`${wanted.label} can not be added here.`);
  return choice;
}
