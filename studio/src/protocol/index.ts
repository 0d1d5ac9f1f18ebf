// What the page and the server say to each other: requests with their results, notifications.

export type * from "./graphs";
export type * from "./live";
export type * from "./methods";
export type * from "./offers";
export type * from "./project";
