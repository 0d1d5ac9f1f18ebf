// Editors end lines with one unit. Files may end them with two, and get back what they had.

export type LineEnd = "\n" | "\r\n";

export interface Lines {
  /** The text with `\n` at each end of a line. */
  text: string;
  /** How the file ends lines; null when it does so in several ways, which no editor gives back. */
  end: LineEnd | null;
}

/** Returns a text as editors hold it, and what its lines ended with. */
export function lines(text: string): Lines {
  const withTwo = text.split("\r\n").length - 1;
  const withFeed = text.split("\n").length - 1;
  const returns = text.split("\r").length - 1;
  if (returns === 0) return { text, end: "\n" };
  const end = returns === withTwo && withFeed === withTwo ? "\r\n" : null;
  return { text: text.replaceAll("\r\n", "\n").replaceAll("\r", "\n"), end };
}

/** Returns the text as the file has it. */
export function asInFile(text: string, end: LineEnd): string {
  return end === "\n" ? text : text.replaceAll("\n", end);
}
