/** Keys of the whole page; placed on the document. */
export function onShortcut(_event: KeyboardEvent): void {}
