/** A difference between two texts, as diff writes it. */
export function Diff({ diff }: { diff: string }) {
  return (
    // biome-ignore lint/a11y/noNoninteractiveTabindex: it scrolls, so keys must reach it
    <pre className="diff" tabIndex={0}>
      {diff.split("\n").map((line, at) => (
        // biome-ignore lint/suspicious/noArrayIndexKey: lines have no other name
        <span key={at} className={KINDS[line[0] ?? ""] ?? ""}>
          {`${line}\n`}
        </span>
      ))}
    </pre>
  );
}

const KINDS: Record<string, string> = { "+": "added", "-": "removed", "@": "place" };
