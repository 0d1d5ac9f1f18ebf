import { useCallback, useLayoutEffect, useRef, useState } from "react";
import { ask, messageOf } from "../../actions";
import type { Method, Params, Result } from "../../protocol";

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
 * Asks the server whenever the question or the revision changes.
 * What was answered to another question is dropped; to the same one it stays till the new one comes,
 * and beside the error if that is none.
 *
 * @param subject What makes two questions the same one, if not their parameters.
 */
export function useAnswer<M extends Method>(
  method: M,
  params: Params<M> | null,
  revision: unknown = 0,
  subject?: string,
): Answer<Result<M>> {
  const text = params === null ? "" : JSON.stringify(params);
  const question = params === null ? "" : (subject ?? text);
  const [answer, setAnswer] = useState<{
    question: string;
    value: Result<M> | null;
    error: string;
  }>({
    question: "",
    value: null,
    error: "",
  });
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
  }, [method, text, question, revision, turn]);

  const again = useCallback(() => setTurn((before) => before + 1), []);
  const isOwn = answer.question === question && question !== "";
  return { value: isOwn ? answer.value : null, error: isOwn ? answer.error : "", isPending, again };
}
