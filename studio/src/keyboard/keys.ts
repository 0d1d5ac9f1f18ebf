// The keys of the page: what each is called in the help, and how an event is named.

/** An event as `Ctrl+Shift+Z`; Meta counts as Ctrl, letters are upper case. */
export function nameOfKey(event: {
  key: string;
  ctrlKey: boolean;
  metaKey: boolean;
  shiftKey: boolean;
  altKey: boolean;
}): string {
  const key = event.key.length === 1 ? event.key.toUpperCase() : event.key;
  // What needs Shift to be typed has it in its name already.
  const isLetter = key.length > 1 || /[A-Z]/.test(key);
  return [
    event.ctrlKey || event.metaKey ? "Ctrl" : "",
    event.altKey ? "Alt" : "",
    event.shiftKey && isLetter ? "Shift" : "",
    key === " " ? "Space" : key,
  ]
    .filter(Boolean)
    .join("+");
}

/** Whether what has the focus takes keys itself: a field, an editor, a dialog. */
export function isTyping(event: Event): boolean {
  const target = event.composedPath()[0];
  if (!(target instanceof Element)) return false;
  if (target.closest("dialog")) return true;
  if (target instanceof HTMLInputElement) {
    return !["checkbox", "radio", "button"].includes(target.type);
  }
  if (target instanceof HTMLTextAreaElement || target instanceof HTMLSelectElement) return true;
  return target.closest("[contenteditable]:not([contenteditable='false'])") !== null;
}

/** A title, and keys with what they do. */
type HelpGroup = readonly [title: string, keys: readonly (readonly [string, string])[]];

/** What the help shows. */
export const HELP: readonly HelpGroup[] = [
  [
    "Everywhere",
    [
      ["Ctrl+Z", "undo"],
      ["Ctrl+Shift+Z, Ctrl+Y", "do again"],
      ["Ctrl+F", "filter the diagram by name; Enter goes to the next that fits"],
      ["G", "go to any element: the outline, and its search"],
      ["M", "fill the map that is shown from what corresponds"],
      ["F6, Shift+F6", "to the next part of the page, or the one before"],
      ["?", "this help"],
    ],
  ],
  [
    "In the diagram",
    [
      ["arrows", "rows up and down; along lines left and right"],
      ["Ctrl+arrows", "to the next box in that direction"],
      ["Shift+arrows", "add what the arrow leads to to the selection"],
      ["Home, End", "to the first row of the box, or the last"],
      ["Enter", "to the form of what is chosen"],
      ["C", "connect to…: search among the ends that are allowed"],
      ["H", "run on host…: the same as dragging boxes into the frame of a host"],
      ["H", "on rows of a bridge, carry by bridge…: the same as dragging them to another bridge"],
      ["F", "to the frame around the box, then to the one around that"],
      ["F2", "rename"],
      ["Delete", "delete; what refers to it is shown first"],
      ["Ctrl+C, Ctrl+X, Ctrl+V", "copy, cut, paste"],
      ["Ctrl+A", "select all boxes"],
      ["Alt+arrows", "move the selected boxes and frames (with Shift: further)"],
      ["U, D, O", "show only what is upstream, downstream, or both"],
      ["A", "arrange: place all boxes anew"],
      ["0, +, -", "show all; larger; smaller"],
      ["T", "diagram or table"],
      ["Escape", "end the focus, then the selection"],
    ],
  ],
  [
    "In the panel Recording",
    [
      ["[, ]", "to the drop before, or the next one, and why it was dropped"],
      ["left, right", "a second on the time line (with Shift: a tenth)"],
      ["PageUp, PageDown", "ten seconds"],
      ["Home, End", "to the beginning, to the end"],
    ],
  ],
  [
    "With the mouse",
    [
      ["drag a box", "move it; into the frame of another host, it runs there then"],
      ["drag a row of a bridge", "move it to another bridge, with all chosen rows"],
      ["drag the title of a frame", "move all that stands in it"],
      ["drag from the end of a row", "draw a line; where it may end lights up"],
      ["Shift and drag", "select what lies in a rectangle"],
      ["Ctrl and click", "add to the selection"],
      ["double click on a name", "rename"],
    ],
  ],
];
