// What can be done: each asks the server and brings its answer into the store.

export * from "./adding";
export * from "./asking";
export * from "./carrying";
export * from "./changing";
export * from "./choosing";
export * from "./connecting";
export * from "./copying";
export * from "./drafting";
export * from "./exporting";
export * from "./listening";
export * from "./placing";
export * from "./removing";
export * from "./renaming";
export * from "./showing";
