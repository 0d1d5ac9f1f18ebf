/** What takes the keyboard in a form, for `querySelector`. */
export const FIELDS = "input, select, textarea, button";
