/** The place of the stick, which is the same at any time: see `operate.css`. */
export const DOCK = "dock-pad";
/** The place of plots. */
export const PLOTS = "plots";
