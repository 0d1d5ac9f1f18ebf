// Asking the server.

import { CallError, type Caller, LOST, messageOf } from "../connection";
import type { Method, Params, Result } from "../protocol";
import { say } from "../store";

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
