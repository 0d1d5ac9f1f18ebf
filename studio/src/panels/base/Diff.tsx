type Kind = "added" | "removed" | "place" | "same";

/** Returns what a line of a unified diff is. */
export function kindOf(line: string): Kind {
  if (line.startsWith("@@") || line.startsWith("+++") || line.startsWith("---")) return "place";
  if (line.startsWith("+")) return "added";
  if (line.startsWith("-")) return "removed";
  return "same";
}

const MOST_SHOWN = 4000;

/** A unified diff, coloured; the signs at the lines say the same. */
export function Diff({ text }: { text: string }) {
  const lines = text.replace(/\n$/, "").split("\n");
  return (
    // biome-ignore lint/a11y/noNoninteractiveTabindex: it scrolls, so keys must reach it
    <pre className="diff" tabIndex={0}>
      {lines.slice(0, MOST_SHOWN).map((line, index) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: lines of a text have no other names
        <span key={index} className={`diff-${kindOf(line)}`}>
          {line}
          {"\n"}
        </span>
      ))}
      {lines.length > MOST_SHOWN && `… ${lines.length - MOST_SHOWN} more lines`}
    </pre>
  );
}
