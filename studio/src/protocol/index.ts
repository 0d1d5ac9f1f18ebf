// What the page and the server say to each other: requests with their results, notifications.

export type * from "./commands";
export type * from "./graphs";
export type * from "./live";
export type * from "./maps";
export type * from "./methods";
export type * from "./offers";
export type * from "./partitions";
export type * from "./plans";
export type * from "./problems";
export type * from "./project";
export type * from "./recordings";
export type * from "./sources";
export type * from "./starting";
export type * from "./steps";
