// The server measures texts by the widths of Helvetica; fonts of this computer may be wider.

const SAMPLE = "The quick brown fox jumps over the lazy dog 0123456789 nav_msgs/Odometry";
/** Width of the sample in Helvetica of 100 pixels. */
const EXPECTED = 3512.7;
const FAMILY = 'Helvetica, Arial, "Liberation Sans", "DejaVu Sans Condensed", sans-serif';

/** Makes texts of the diagram as much smaller as the font at hand is too wide. */
export function fitTexts(root: HTMLElement): void {
  const context = document.createElement("canvas").getContext("2d");
  if (!context) return;
  context.font = `100px ${FAMILY}`;
  const { width } = context.measureText(SAMPLE);
  root.style.setProperty("--text-scale", String(Math.min(1, EXPECTED / width)));
}
