// Who else has the project open.

import type { Ref } from "./project";

/** A page that is open, and where it looks. */
export interface PresentPage {
  id: string;
  /** Whether it is a page of this studio, and not of another one on this computer. */
  here: boolean;
  /** What the person typed, empty where nobody did. */
  name: string;
  file: string;
  view: string;
  element: Ref | "";
}
