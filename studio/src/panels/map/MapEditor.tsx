export function MapEditor() {
  return null;
}
