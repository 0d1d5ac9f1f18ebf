import { type DragEvent, type KeyboardEvent, useId, useState } from "react";
import { ask, change, DRAGGED, messageOf } from "../../actions";
import type { PaletteGroup, PaletteItem } from "../../protocol";
import { useStudio } from "../../store";
import { Fault, Quiet } from "../base/parts";
import { useRevision } from "../base/studio";
import { useAnswer } from "../base/useAnswer";
import { useSettled } from "../base/useSettled";
import { type Recent, recent, remember } from "./recent";

const GROUPS: PaletteGroup[] = ["elements", "components", "services", "ros types", "ready maps"];
const PAUSE_MS = 80;

interface Offer {
  item: Recent & Partial<PaletteItem>;
  group: string;
}

/** What can be added to the file: searched as one types, dragged to the diagram, or added by Enter. */
export function Palette() {
  const file = useStudio((state) => state.file);
  const revision = useRevision();
  const [typed, setTyped] = useState("");
  const query = useSettled(typed.trim(), PAUSE_MS);
  const { value, error } = useAnswer("palette", file ? { file, query } : null, revision);
  const [kept, setKept] = useState(() => recent(localStorage));
  const [at, setAt] = useState(0);
  const [fault, setFault] = useState("");
  const list = useId();

  const items = value?.items ?? [];
  const offers: Offer[] = [
    ...(query === "" ? kept.map((item) => ({ item, group: "recently used" })) : []),
    ...GROUPS.flatMap((group) =>
      items.filter((each) => each.group === group).map((item) => ({ item, group })),
    ),
  ];
  const active = Math.min(at, offers.length - 1);

  async function add(item: Offer["item"]) {
    try {
      const whole = item.drop ? (item as PaletteItem) : await lookUp(file, item);
      await change(whole.drop.commands, whole.label_of_edit);
      setKept(remember(localStorage, whole));
      setFault("");
    } catch (error) {
      setFault(messageOf(error));
    }
  }

  function onKeyDown(event: KeyboardEvent) {
    if (event.key === "ArrowDown" || event.key === "ArrowUp") {
      event.preventDefault();
      const step = event.key === "ArrowDown" ? 1 : -1;
      setAt((active + step + offers.length) % Math.max(offers.length, 1));
    } else if (event.key === "Enter") {
      event.preventDefault();
      const offer = offers[active];
      if (offer) add(offer.item);
    } else if (event.key === "Escape" && typed !== "") {
      event.stopPropagation();
      setTyped("");
    }
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
        spellCheck={false}
        value={typed}
        onChange={(event) => {
          setTyped(event.currentTarget.value);
          setAt(0);
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
            onPoint={() => setAt(index)}
            onAdd={() => add(offer.item)}
          />
        ))}
      </div>
      {value && offers.length === 0 && <Quiet>Nothing has this name.</Quiet>}
      <Quiet>Drag to the diagram, or choose with ↑ ↓ and press Enter to add.</Quiet>
    </section>
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
      {isFirst && (
        <h4 role="presentation" className="group">
          {group}
        </h4>
      )}
      {/* biome-ignore lint/a11y/useFocusableInteractive: the focus stays in the input, which names the active one */}
      {/* biome-ignore lint/a11y/useKeyWithClickEvents: keys are those of the input */}
      <div
        id={id}
        role="option"
        aria-selected={isActive}
        className="offer"
        draggable={item.drop !== undefined}
        title={item.documentation}
        ref={(element) => {
          if (isActive) element?.scrollIntoView?.({ block: "nearest" });
        }}
        onDragStart={onDragStart}
        onClick={onPoint}
        onDoubleClick={onAdd}
      >
        <span className="offer-label">{item.label}</span>
        {item.note && <span className="offer-note">{item.note}</span>}
        {isActive && item.documentation && <small>{item.documentation}</small>}
        {isActive && (
          <button
            type="button"
            className="small"
            tabIndex={-1}
            onClick={onAdd}
            aria-label={`Add ${item.label}`}
          >
            Add
          </button>
        )}
      </div>
    </>
  );
}

async function lookUp(file: string, wanted: Recent): Promise<PaletteItem> {
  const { items } = await ask("palette", { file, query: wanted.label });
  const found = items.find((each) => each.id === wanted.id);
  if (!found) throw new Error(`${wanted.label} can not be added here.`);
  return found;
}
