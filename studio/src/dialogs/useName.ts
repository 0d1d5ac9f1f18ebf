import { useEffect, useLayoutEffect, useRef, useState } from "react";

/**
 * A name that is typed, perhaps before the present one is known: taking waits for that.
 *
 * @param name The present name, null until it is known.
 */
export function useName(name: string | null, onDone: (name: string) => void) {
  const [typed, setText] = useState<string | null>(null);
  const [isTaken, setTaken] = useState(false);
  /** In which the name is typed. */
  const field = useRef<HTMLInputElement>(null);
  const text = typed ?? name ?? "";

  useEffect(() => {
    if (name !== null && isTaken) onDone(text.trim());
  }, [name, isTaken, text, onDone]);

  const isUntouched = typed === null;
  // At once: the next key writes over it.
  useLayoutEffect(() => {
    if (name !== null && isUntouched) field.current?.select();
  }, [name, isUntouched]);

  /** Takes what was typed. */
  const take = () => (name === null ? setTaken(true) : onDone(text.trim()));
  return { field, text, setText, take };
}
