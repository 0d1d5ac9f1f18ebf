// What is played: which recording is open, the moment that is shown, and what is asked of it.

import { create } from "zustand";
import { ask, messageOf } from "../../actions";
import type { Mark, ReadRecording } from "../../protocol";
import { say, state, update } from "../../store";

const CLOSED = {
  /** Name of the recording; empty for none. */
  name: "",
  read: null as ReadRecording | null,
  /** How much is read, up to 1. */
  share: 0,
  fault: "",
  /** Seconds since the beginning. */
  at: 0,
  isPlaying: false,
  /** The connection that is explained. */
  chosen: null as { bridge: string; connection: string } | null,
};

export const usePlayer = create(() => CLOSED);
export const player = () => usePlayer.getState();
export const put = usePlayer.setState;

const LOOK_MS = 300;

/** Opens a recording; what it tells takes the place of what runs. */
export async function open(name: string): Promise<void> {
  put({ ...CLOSED, name });
  update({ live: null, recorded: name });
  const read = await reading(name);
  if (read === null) return;
  put({ read });
  say(read.damage ? `${name}: ${read.damage}.` : `${name} is read.`, Boolean(read.damage));
  goTo(0);
}

export function close(): void {
  put(CLOSED);
  update({ live: null, recorded: "" });
}

/** Asks how far a recording is read until it is; null where it cannot be, or nobody waits. */
async function reading(name: string): Promise<ReadRecording | null> {
  const isOpen = () => player().name === name;
  while (isOpen()) {
    try {
      const { read, share, fault } = await ask("recording.open", { recording: name });
      if (!isOpen()) return null;
      if (read) return read;
      put({ share, fault });
      if (fault) return null;
    } catch (error) {
      if (isOpen()) put({ fault: messageOf(error) });
      return null;
    }
    await new Promise((done) => setTimeout(done, LOOK_MS));
  }
  return null;
}

/** Shows a moment. */
export function goTo(at: number): void {
  const { read } = player();
  if (!read) return;
  put({ at: Math.min(Math.max(0, at), read.duration) });
  void look();
}

let isLooking = false;
let isWanted = false;

/** Asks for the moment, one at a time: while one is on its way, only the last wish counts. */
export async function look(): Promise<void> {
  isWanted = true;
  if (isLooking) return;
  isLooking = true;
  while (isWanted) {
    isWanted = false;
    const { name, at } = player();
    try {
      const moment = await ask("recording.state", { recording: name, file: state().file, at });
      if (player().name === name && state().recorded === name)
        update({ live: moment.state, liveAt: 0 });
      if (player().name === name) put({ fault: "" });
    } catch (error) {
      put({ fault: messageOf(error) });
    }
  }
  isLooking = false;
}

/** The mark of a kind after a moment, or the one before it. */
export function nextMark(marks: Mark[], kind: Mark["kind"], at: number, step: 1 | -1) {
  const fitting = marks.filter((mark) => mark.kind === kind);
  // Moments are shown to the hundredth.
  return step > 0
    ? fitting.find((mark) => mark.time > at + 0.005)
    : fitting.findLast((mark) => mark.time < at - 0.005);
}

/** Goes to the next drop, or the one before, and explains it. */
export function stepToDrop(step: 1 | -1): void {
  const { read, at } = player();
  const drop = read && nextMark(read.marks, "drop", at, step);
  if (!drop) {
    if (read) say(step > 0 ? "No drop comes after this." : "No drop comes before this.");
    return;
  }
  const { bridge, connection } = drop;
  put({ chosen: { bridge, connection }, isPlaying: false });
  goTo(drop.time);
}
