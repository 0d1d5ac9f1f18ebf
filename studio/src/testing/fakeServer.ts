// A server in the process: answers what a test tells it to, and keeps what it was asked.

import { use } from "../actions";
import { CallError, type Caller } from "../connection";
import type { Method, Params, Project, Result } from "../protocol";
import { update } from "../store";

type Answers = { [M in Method]?: (params: Params<M>) => Result<M> | Promise<Result<M>> };

export interface Asked {
  method: Method;
  params: unknown;
}

export class FakeServer implements Caller {
  readonly asked: Asked[] = [];
  private readonly answers: Answers;

  constructor(answers: Answers = {}) {
    this.answers = answers;
  }

  async call<M extends Method>(method: M, params: Params<M>): Promise<Result<M>> {
    this.asked.push({ method, params });
    const answer = this.answers[method] as ((params: Params<M>) => Result<M>) | undefined;
    if (!answer) throw new CallError(-32601, `there is no method ${method}`);
    return answer(params);
  }

  /** Changes what it answers. */
  answer<M extends Method>(method: M, answer: (params: Params<M>) => Result<M>): void {
    (this.answers as Record<string, unknown>)[method] = answer;
  }

  /** Parameters of every request of a method, the oldest first. */
  params<M extends Method>(method: M): Params<M>[] {
    return this.asked
      .filter((request) => request.method === method)
      .map((request) => request.params as never);
  }
}

export const PROJECT: Project = {
  name: "robot",
  root: "/robot",
  revision: 1,
  files: [{ path: "robot.xmi", notation: "xmi", stale: false, dirty: false }],
  opened: "robot.xmi",
  undoable: true,
  redoable: true,
};

/** Gives the page a server, as if it had just been greeted. */
export function serve(answers: Answers = {}, project: Project = PROJECT): FakeServer {
  const server = new FakeServer(answers);
  use(server);
  update({ link: "open", project, file: project.opened, view: "system" });
  return server;
}
