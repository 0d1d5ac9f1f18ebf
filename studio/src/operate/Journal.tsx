import { clock } from "../panels/base/parts";
import { useUnit } from "./unit";

const MOST_SHOWN = 100;

/** What was commanded, by whom, and what came of it; the latest first. */
export function Journal() {
  const journal = useUnit((unit) => unit.journal);
  return (
    <section className="journal" aria-label="Journal">
      <h2>Journal</h2>
      {/* biome-ignore lint/a11y/noNoninteractiveTabindex: it scrolls by keys */}
      <ol tabIndex={0} aria-label="Entries, the latest first">
        {journal
          .slice(-MOST_SHOWN)
          .reverse()
          .map((entry) => (
            <li key={entry.number}>
              <time>{clock(entry.time)}</time> <strong>{entry.who}</strong> {entry.text}
            </li>
          ))}
      </ol>
    </section>
  );
}
