import { useEffect, useState } from "react";

/**
 * Does what was asked for as soon as it can be done: Enter waits for what was searched or judged.
 *
 * @returns What asks for it, or takes that back.
 */
export function useOnceReady(isReady: boolean, act: () => void): (isWanted: boolean) => void {
  const [isWanted, setWanted] = useState(false);
  useEffect(() => {
    if (!isWanted || !isReady) return;
    setWanted(false);
    act();
  });
  return setWanted;
}
