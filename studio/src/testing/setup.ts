import "@testing-library/jest-dom/vitest";
import { cleanup, configure } from "@testing-library/preact";
import { afterEach, beforeEach } from "vitest";
import { BEGINNING, useStudio } from "../store";

// jsdom lays nothing out, and so lacks what watches layouts.
class NoObserver {
  observe() {}
  unobserve() {}
  disconnect() {}
}
globalThis.ResizeObserver ??= NoObserver as unknown as typeof ResizeObserver;
globalThis.DOMMatrixReadOnly ??= class {
  m22 = 1;
} as unknown as typeof DOMMatrixReadOnly;
Range.prototype.getClientRects ??= () => [] as unknown as DOMRectList;
// By its vendor jsdom would be Safari, whose faults editors work around.
Object.defineProperty(navigator, "vendor", { value: "" });
Element.prototype.scrollIntoView ??= () => {};
window.matchMedia ??= ((query: string) => ({
  matches: false,
  media: query,
  addEventListener() {},
  removeEventListener() {},
})) as unknown as typeof window.matchMedia;
HTMLDialogElement.prototype.showModal ??= function (this: HTMLDialogElement) {
  this.open = true;
};
HTMLDialogElement.prototype.close ??= function (this: HTMLDialogElement) {
  this.open = false;
  this.dispatchEvent(new Event("close"));
};

// Other work of the machine may take long; what does not come at all still fails.
configure({ asyncUtilTimeout: 20_000 });

beforeEach(() => {
  document.head.replaceChildren();
  useStudio.setState(BEGINNING, true);
});
afterEach(cleanup);
