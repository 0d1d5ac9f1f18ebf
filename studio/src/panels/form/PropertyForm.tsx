export function PropertyForm() {
  return null;
}
