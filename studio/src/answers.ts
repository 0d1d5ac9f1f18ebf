import { useCallback, useEffect, useLayoutEffect, useRef, useState } from "react";
import { messageOf } from "./connection";

export interface Answer<T> {
  /** The last answer to the present question; an older one stays until the new one has come. */
  value: T | null;
  /** Why there is no answer, for people. */
  error: string;
  isPending: boolean;
  /** Asks again. */
  again: () => void;
}

/**
 * Asks a server whenever the question or the revision changes.
 * What was answered to another question is dropped; to the same one it stays till the new one comes,
 * and beside the error if that is none.
 *
 * @param subject What makes two questions the same one, if not their parameters.
 */
export function useAnswerOf<M extends string, P, R>(
  ask: (method: M, params: P) => Promise<R>,
  method: M,
  params: P | null,
  revision: unknown = 0,
  subject?: string,
): Answer<R> {
  const text = params === null ? "" : JSON.stringify(params);
  const question = params === null ? "" : (subject ?? text);
  const [answer, setAnswer] = useState({ question: "", value: null as R | null, error: "" });
  const [turn, setTurn] = useState(0);
  const [isPending, setPending] = useState(false);
  const asked = useRef(params);
  asked.current = params;

  // At once, and not after the next frame: a key may come before that, and must not be for what is old.
  // biome-ignore lint/correctness/useExhaustiveDependencies: a new revision or turn asks the same again
  useLayoutEffect(() => {
    if (asked.current === null) return;
    let isWanted = true;
    setPending(true);
    ask(method, asked.current).then(
      (value) => {
        if (!isWanted) return;
        setPending(false);
        setAnswer({ question, value, error: "" });
      },
      (error: unknown) => {
        if (!isWanted) return;
        setPending(false);
        setAnswer((before) => ({
          question,
          value: before.question === question ? before.value : null,
          error: messageOf(error),
        }));
      },
    );
    return () => {
      isWanted = false;
    };
  }, [ask, method, text, question, revision, turn]);

  const again = useCallback(() => setTurn((before) => before + 1), []);
  const isOwn = answer.question === question && question !== "";
  return { value: isOwn ? answer.value : null, error: isOwn ? answer.error : "", isPending, again };
}

/** Why work was refused the last time, for people, and what does such work. */
export function useTrying(): [string, (work: () => Promise<unknown>) => Promise<void>] {
  const [fault, setFault] = useState("");
  const attempt = useCallback(async (work: () => Promise<unknown>) => {
    setFault("");
    await work().catch((error: unknown) => setFault(messageOf(error)));
  }, []);
  return [fault, attempt];
}

/** What is asked for again and again while it is shown: the last answer, null before the first. */
export function usePolled<T>(look: () => Promise<T>, milliseconds: number): T | null {
  const [latest, setLatest] = useState<T | null>(null);
  useEffect(() => {
    let isWanted = true;
    const again = () =>
      look().then(
        (value) => isWanted && setLatest(value),
        () => undefined, // the next one may be answered
      );
    void again();
    const timer = setInterval(again, milliseconds);
    return () => {
      isWanted = false;
      clearInterval(timer);
    };
  }, [look, milliseconds]);
  return latest;
}

/**
 * Does what was asked for as soon as it can be done: Enter waits for what was searched or judged.
 *
 * @returns What asks for it, or takes that back.
 */
export function useOnceReady(isReady: boolean, act: () => void): (isWanted: boolean) => void {
  const [isWanted, setWanted] = useState(false);
  useEffect(() => {
    if (!isWanted || !isReady) return;
    setWanted(false);
    act();
  });
  return setWanted;
}

/** The value, once it has not changed for some milliseconds: for what is asked while somebody types. */
export function useSettled<T>(value: T, milliseconds: number): T {
  const [settled, setSettled] = useState(value);
  useEffect(() => {
    const timer = setTimeout(() => setSettled(value), milliseconds);
    return () => clearTimeout(timer);
  }, [value, milliseconds]);
  return settled;
}
