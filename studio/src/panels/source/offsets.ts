// Python counts characters, JavaScript and the language server UTF-16 units.

/** Returns the offset in units of an offset in characters. */
export function units(text: string, characters: number): number {
  let at = 0;
  for (let count = 0; count < characters && at < text.length; count++)
    at += (text.codePointAt(at) ?? 0) > 0xffff ? 2 : 1;
  return at;
}

/** Returns the offset in characters of an offset in units. */
export function characters(text: string, units: number): number {
  let count = 0;
  for (let at = 0; at < units && at < text.length; count++)
    at += (text.codePointAt(at) ?? 0) > 0xffff ? 2 : 1;
  return count;
}
