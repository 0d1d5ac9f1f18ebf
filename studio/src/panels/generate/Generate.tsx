export function Generate() {
  return null;
}
