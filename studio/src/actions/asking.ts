// Asking the server.

import { CallError, type Caller, LOST, messageOf } from "../connection";
import type { Method, Params, Result } from "../protocol";
import { type Dialog, say, state, update } from "../store";

let caller: Caller | null = null;

/** Gives the actions the connection that they use. */
export function use(connection: Caller): void {
  caller = connection;
}

/** Asks the server; use it for what changes nothing. */
export function ask<M extends Method>(method: M, params: Params<M>): Promise<Result<M>> {
  if (!caller) return Promise.reject(new CallError(LOST, "There is no connection to the server."));
  return caller.call(method, params) as Promise<Result<M>>;
}

export { messageOf };

/** Awaits, and tells the user what went wrong; undefined then. */
export async function tried<T>(work: Promise<T>): Promise<T | undefined> {
  try {
    return await work;
  } catch (error) {
    say(messageOf(error), true);
    return undefined;
  }
}

/**
 * Opens a dialog at once, and fills it when the answer comes: what is typed meanwhile is for it, and
 * not for the diagram. The answer to a dialog that was closed or replaced meanwhile is not wanted.
 *
 * @param fill What the answer makes of the dialog, null to close it.
 */
export async function openFor<T>(
  dialog: Dialog,
  work: Promise<T>,
  fill: (answer: T) => Dialog | null,
): Promise<void> {
  update({ dialog });
  const answer = await tried(work);
  if (state().dialog === dialog) update({ dialog: answer === undefined ? null : fill(answer) });
}
