import { ask } from "../../actions";
import { type Answer, useAnswerOf } from "../../answers";
import type { Method, Params, Result } from "../../protocol";

/** What the server answers: see `useAnswerOf`. */
export const useAnswer = <M extends Method>(
  method: M,
  params: Params<M> | null,
  revision?: unknown,
  subject?: string,
): Answer<Result<M>> => useAnswerOf(ask<M>, method, params, revision, subject);
