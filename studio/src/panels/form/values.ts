import type { FormField } from "../../protocol";

const INTEGER = /^[+-]?(0[xX][0-9a-fA-F]+|\d+)$/;
const NUMBER = /^[+-]?(\d+\.?\d*([eE][+-]?\d+)?|\.\d+([eE][+-]?\d+)?|Infinity|INF|NaN)$/;

/** Why a text cannot be a value of a field; empty if it may be. The server has the last word. */
export function fault(field: Pick<FormField, "kind" | "required" | "label">, text: string): string {
  if (text === "") return field.required ? `${field.label} must have a value` : "";
  if (field.kind === "integer" && !INTEGER.test(text)) return `'${text}' is no whole number`;
  if (field.kind === "number" && !NUMBER.test(text) && !INTEGER.test(text))
    return `'${text}' is no number`;
  return "";
}

/** What a value is called: its label where it has one. */
export function shownAs(field: FormField, index: number): string {
  const value = field.values[index] ?? "";
  return (
    field.shown[index] || field.choices.find((choice) => choice.value === value)?.label || value
  );
}

/** A list with one of its values at another place. */
export function moved<T>(values: readonly T[], from: number, to: number): T[] {
  const rest = values.filter((_, index) => index !== from);
  const value = values[from];
  if (value === undefined) return [...values];
  return [...rest.slice(0, to), value, ...rest.slice(to)];
}
