// A stick that is held: it says what it commands again and again, and its end is told at once.

import { messageOf } from "../connection";
import { ask, tell } from "./unit";

/** Words in the time that one of them holds. */
const WORDS = 5;
const SHORTEST_MS = 40;

export class HeldStick {
  private number: number | null = null;
  private timer: ReturnType<typeof setInterval> | undefined;
  private isOver = false;
  private isSaying = false;
  private readonly fields: () => object;
  private readonly onOver: () => void;

  /**
   * @param fields What is commanded now.
   * @param onOver Is called when it ends, whoever ends it.
   */
  constructor(fields: () => object, onOver: () => void) {
    this.fields = fields;
    this.onOver = onOver;
  }

  async begin(component: string, message: string): Promise<void> {
    for (const name of ENDS) window.addEventListener(name, this.end);
    document.addEventListener("visibilitychange", this.endIfHidden);
    try {
      const { stick, timeout } = await ask("stick.begin", { component, message });
      this.number = stick;
      if (this.isOver) {
        // It was let go meanwhile.
        await ask("stick.end", { stick });
        return;
      }
      this.say();
      this.timer = setInterval(this.say, Math.max(SHORTEST_MS, (1000 * timeout) / WORDS));
    } catch (error) {
      this.fail(error);
    }
  }

  /** Lets go. */
  readonly end = (): void => {
    if (this.close() && this.number !== null) {
      ask("stick.end", { stick: this.number }).catch((error) => tell(messageOf(error), true));
    }
  };

  private readonly endIfHidden = (): void => {
    if (document.hidden) this.end();
  };

  private readonly say = (): void => {
    // A server that is slow is not told older words when newer ones are known.
    if (this.isSaying || this.isOver || this.number === null) return;
    this.isSaying = true;
    ask("stick.move", { stick: this.number, fields: this.fields() }).then(
      () => {
        this.isSaying = false;
      },
      (error) => this.fail(error),
    );
  };

  private fail(error: unknown): void {
    if (!this.isOver) tell(messageOf(error), true);
    this.end();
  }

  /** Says nothing any more; false if it did not before. */
  private close(): boolean {
    if (this.isOver) return false;
    this.isOver = true;
    clearInterval(this.timer);
    for (const name of ENDS) window.removeEventListener(name, this.end);
    document.removeEventListener("visibilitychange", this.endIfHidden);
    this.onOver();
    return true;
  }
}

/** What may happen between a hand and its letting go: a window of another size has another layout. */
const ENDS = ["blur", "pagehide", "resize"] as const;
