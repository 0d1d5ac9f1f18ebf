// Whether the page operates: all that the rest of the page knows of it.

import { create } from "zustand";
import { RIGHT_KEY } from "../connection";

/** Whether this tab was opened with the right to command. */
export const hasRight = (): boolean => sessionStorage.getItem(RIGHT_KEY) !== null;

export const useOperating = create<{ isOpen: boolean }>(() => ({ isOpen: false }));
export const operate = (isOpen: boolean): void => useOperating.setState({ isOpen });
