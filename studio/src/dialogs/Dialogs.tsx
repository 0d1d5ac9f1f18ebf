import { type FormEvent, Fragment, useEffect, useRef, useState } from "react";
import { bridgesOf, carry, choose, connect, edit, placeOn, rename, take } from "../actions";
import { hostsOf } from "../canvas/frames";
import { HELP } from "../keyboard/keys";
import { Diff } from "../panels/base/Diff";
import { Copyable } from "../panels/base/parts";
import { useAnswer } from "../panels/base/useAnswer";
import type { ConnectOption } from "../protocol";
import { type Dialog, update, useStudio } from "../store";
import { Modal } from "./Modal";
import { NewModel } from "./NewModel";
import { Partition } from "./Partition";
import { Picker } from "./Picker";
import { useName } from "./useName";

type Of<K extends Dialog["kind"]> = { dialog: Extract<Dialog, { kind: K }> };

const close = () => update({ dialog: null });

/** The dialog that is open. */
export function Dialogs() {
  const dialog = useStudio((studio) => studio.dialog);
  if (!dialog) return null;
  switch (dialog.kind) {
    case "help":
      return <Help />;
    case "operate":
      return <Operate />;
    case "delete":
      return <Delete dialog={dialog} />;
    case "ends":
      return <Ends dialog={dialog} />;
    case "connect":
      return <Connect dialog={dialog} />;
    case "hosts":
      return <Hosts dialog={dialog} />;
    case "bridges":
      return <Bridges dialog={dialog} />;
    case "partition":
      return <Partition onClose={close} />;
    case "rename":
      return <Rename dialog={dialog} />;
    case "create":
      return <NewModel points={dialog.points} onClose={close} />;
    case "diff":
      return (
        <Modal title={dialog.title} onClose={close} isWide>
          <Diff text={dialog.diff} />
        </Modal>
      );
  }
}

function Help() {
  return (
    <Modal title="Keys" onClose={close} isWide>
      <div className="help">
        {HELP.map(([title, keys]) => (
          <section key={title}>
            <h3>{title}</h3>
            <dl>
              {keys.map(([key, does]) => (
                <Fragment key={does}>
                  <dt>
                    <kbd>{key}</kbd>
                  </dt>
                  <dd>{does}</dd>
                </Fragment>
              ))}
            </dl>
          </section>
        ))}
        <section>
          <h3>How to read the diagram</h3>
          <p>
            Square boxes speak JAUS, thick ones are bridges, rounded ones are of ROS. Dashed lines
            are for control. × and ! mark errors and warnings; point at them for the words. While a
            running system is watched, dashed boxes and lines are silent, doubled ones fail; a ✝
            marks what was heard and is no more.
          </p>
        </section>
      </div>
    </Modal>
  );
}

/** Who commands decides what is safe, on the command line of a process of its own. */
function Operate() {
  const file = useStudio((studio) => studio.file);
  const line = `jausml operate ${file} --stop-all standby --lease 2`;
  return (
    <Modal title="Operate" onClose={close}>
      <p>
        Components are commanded by a program of its own, which nothing here can hold up. Start it
        in the folder of this project, and say what is safe: what <b>Stop</b> does (standby or
        emergency), and for how many seconds its page may be silent. <code>--stop</code> adds the
        stop of a command; <code>jausml operate --help</code> tells more.
      </p>
      <Copyable label="the command" text={line} />
    </Modal>
  );
}

function Delete({ dialog }: Of<"delete">) {
  const { commands, label, referrers, diff, base } = dialog;
  const agree = useRef<HTMLButtonElement>(null);
  useEffect(() => {
    if (referrers) agree.current?.focus();
  }, [referrers]);
  function onDelete() {
    close();
    void edit(commands, label, base);
  }
  if (!referrers) {
    return (
      <Modal title={`${label}?`} onClose={close} isShort>
        <p className="quiet">Looking who refers to it…</p>
      </Modal>
    );
  }
  return (
    <Modal title={`${label}?`} onClose={close}>
      <p>
        {referrers.length === 1 ? "One element refers" : `${referrers.length} elements refer`} to
        it. These lose the reference, or go with it where they cannot be without:
      </p>
      <ul className="referrers">
        {referrers.map((referrer) => (
          <li key={referrer.element}>
            <button
              type="button"
              className="link"
              onClick={() => {
                close();
                choose(referrer.element);
              }}
            >
              {referrer.label}
            </button>
          </li>
        ))}
      </ul>
      {diff && (
        <details>
          <summary>What changes in the files</summary>
          <Diff text={diff} />
        </details>
      )}
      <footer>
        <button type="button" onClick={close}>
          Keep it
        </button>
        <button ref={agree} type="button" className="best" onClick={onDelete}>
          Delete
        </button>
      </footer>
    </Modal>
  );
}

function Ends({ dialog }: Of<"ends">) {
  const { from, ends } = dialog;
  return (
    <Modal title="Connect to…" onClose={close}>
      {ends?.length === 0 && <p className="quiet">There is nothing that it may be connected to.</p>}
      {ends?.length !== 0 && (
        <Picker
          label="ends that are allowed"
          isLooking={!ends}
          picks={(ends ?? []).map((end) => ({
            id: `${end.node} ${end.port}`,
            text: `${end.label} ${end.why}`,
            shown: (
              <>
                <strong>{end.label}</strong> <small>{end.why}</small>
              </>
            ),
          }))}
          onPick={(at) => {
            const end = ends?.[at];
            if (end) void connect(from, { node: end.node, port: end.port });
          }}
        />
      )}
    </Modal>
  );
}

function Connect({ dialog }: Of<"connect">) {
  const isLooking = !dialog.options;
  const options = [...(dialog.options ?? [])].sort((a, b) => Number(b.is_best) - Number(a.is_best));
  // A field into which one has begun to type stays.
  const [isSearched] = useState(isLooking || options.length > 8);
  if (!isLooking && !options.length) {
    return (
      <Modal key="refusal" title="This cannot be connected" onClose={close}>
        <p role="alert">{dialog.refusal || "No rule allows it."}</p>
        <footer>
          <button type="button" className="best" onClick={close}>
            Understood
          </button>
        </footer>
      </Modal>
    );
  }
  return (
    <Modal title="Connect how?" onClose={close}>
      {dialog.refusal && <p>{dialog.refusal}</p>}
      <Picker
        label="ways to connect"
        isSearched={isSearched}
        isLooking={isLooking}
        picks={options.map((option, at) => ({
          id: `${at} ${option.label}`,
          text: `${option.label} ${option.why}`,
          shown: (
            <>
              <strong>{option.label}</strong>
              {option.is_best && <em> fits best</em>}
              <div>{option.why}</div>
              {option.preview && <pre>{option.preview}</pre>}
            </>
          ),
        }))}
        details={(at) => <Written option={options[at]} base={dialog.revision} />}
        onPick={(at) => {
          const option = options[at];
          if (option) void take(option, dialog.revision);
        }}
      />
    </Modal>
  );
}

/** What a way to connect writes, as it does when it is taken. */
function Written({
  option,
  base,
}: {
  option?: ConnectOption | undefined;
  base?: number | undefined;
}) {
  const { label = "", commands = [] } = option ?? {};
  const asked = { commands, label, dry: true, ...(base !== undefined && { base }) };
  const { value, error } = useAnswer("edit", option ? asked : null);
  return error ? <p className="quiet">{error}</p> : value && <Diff text={value.diff ?? ""} />;
}

function Hosts({ dialog }: Of<"hosts">) {
  const graph = useStudio((studio) => studio.graph);
  return (
    <Choose
      title="Run on host…"
      label="hosts of the system"
      parts={graph ? hostsOf(graph) : []}
      onChoose={(host) => void placeOn(host, dialog.boxes, {})}
    />
  );
}

function Bridges({ dialog }: Of<"bridges">) {
  const graph = useStudio((studio) => studio.graph);
  const bridges = graph ? bridgesOf(graph) : [];
  return (
    <Choose
      title="Carry by bridge…"
      label="bridges of the system"
      parts={[...bridges, { id: "", title: "a new bridge" }]}
      onChoose={(bridge) => void carry(dialog.elements, bridge)}
    />
  );
}

interface ChooseProps {
  title: string;
  label: string;
  parts: readonly { id: string; title: string }[];
  onChoose(id: string): void;
}

/** A part of the diagram that is chosen by its title. */
function Choose({ title, label, parts, onChoose }: ChooseProps) {
  return (
    <Modal title={title} onClose={close}>
      <Picker
        label={label}
        picks={parts.map(({ id, title }) => ({ id, text: title, shown: <strong>{title}</strong> }))}
        onPick={(at) => {
          const part = parts[at];
          close();
          if (part) onChoose(part.id);
        }}
      />
    </Modal>
  );
}

function Rename({ dialog }: Of<"rename">) {
  const { element, name, base } = dialog;
  const { field, text, setText, take } = useName(
    name,
    (typed) => void rename(element, name ?? "", typed, base),
  );
  function onSubmit(event: FormEvent) {
    event.preventDefault();
    take();
  }
  return (
    <Modal title={name === null ? "Rename…" : `Rename ${name}`} onClose={close}>
      <form onSubmit={onSubmit}>
        <label>
          New name{" "}
          <input
            ref={field}
            spellCheck="false"
            value={text}
            onChange={(event) => setText(event.currentTarget.value)}
          />
        </label>
        <footer>
          <button type="submit" className="best" disabled={name !== null && !text.trim()}>
            Rename
          </button>
        </footer>
      </form>
    </Modal>
  );
}
