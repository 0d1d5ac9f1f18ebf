import { useUnit } from "./unit";

/** Seconds without a report after which its values are told to be old. */
export const OLD_S = 3;

interface Props {
  /** Seconds as the unit said them with its last word; null for what was never heard. */
  seconds: number | null;
  /** Seconds after which it is old. */
  limit: number;
}

/** How old something is now: it grows also while the unit says nothing. */
export function Age({ seconds, limit }: Props) {
  const silence = useUnit((unit) => unit.silence);
  if (seconds === null) return <small className="age">nothing yet</small>;
  const age = seconds + silence;
  const text = `${age.toFixed(1)} s`;
  return <small className="age">{age > limit ? `✝ ${text} old` : `${text} ago`}</small>;
}
