// What the page and the server say to each other: requests with their results, notifications.

/** `<file>#<fragment>` of an element of a model; valid for one revision of the project. */
export type Ref = string;

/** Name path of an element, such as `bridge:main/velocity`; positions of boxes are kept by it. */
export type LayoutKey = string;

export type Point = [number, number];

export interface FileInfo {
  path: string;
  notation: "xmi" | "text";
  revision: number;
  /** The model is the last one that could be read. */
  stale: boolean;
  /** The text cannot be parsed at the moment. */
  dirty: boolean;
}

export interface Project {
  name: string;
  root: string;
  version: string;
  revision: number;
  files: FileInfo[];
  /** The file to show first, empty for none. */
  opened: string;
  extras: { live: boolean; graphviz: boolean };
}

export type ViewKind = "system" | "map" | "service" | "machine";

export interface ViewInfo {
  name: string;
  kind: ViewKind;
  title: string;
  library: boolean;
}

// Commands -----------------------------------------------------------------------------------

export interface Child {
  feature: string;
  kind: string;
  values: Record<string, string[]>;
  children?: Child[];
}

export interface SetCommand {
  kind: "set";
  element: Ref;
  feature: string;
  values: string[];
}

export interface AddCommand {
  kind: "add";
  owner: Ref;
  feature: string;
  /** Qualified class; named `type` since `kind` names the command. */
  type: string;
  values: Record<string, string[]>;
  children?: Child[];
  position?: number | null;
}

export interface RemoveCommand {
  kind: "remove";
  element: Ref;
}

export interface MoveCommand {
  kind: "move";
  element: Ref;
  owner: Ref;
  feature: string;
  position?: number | null;
}

export interface RenameCommand {
  kind: "rename";
  element: Ref;
  name: string;
}

export interface CreateCommand {
  kind: "create";
  file: string;
  type: string;
  values: Record<string, string[]>;
}

export interface PlaceCommand {
  kind: "place";
  file: string;
  view: string;
  /** null forgets: the layout decides again. */
  positions: Record<LayoutKey, Point | null>;
}

export type Command =
  | SetCommand
  | AddCommand
  | RemoveCommand
  | MoveCommand
  | RenameCommand
  | CreateCommand
  | PlaceCommand;

export interface Entry {
  number: number;
  label: string;
  files: string[];
  created: Ref[];
}

export interface Referrer {
  element: Ref;
  label: string;
}

export interface EditResult {
  revision: number;
  entry?: Entry | null;
  created: Ref[];
  diff?: string;
  referrers?: Referrer[];
}

// Graphs -------------------------------------------------------------------------------------

export type Severity = "error" | "warning" | "info";

export interface Finding {
  severity: Severity;
  rule: string;
  message: string;
}

export type Details = [string, string][];

export interface GraphPort {
  id: string;
  element: Ref | "";
  key: LayoutKey;
  label: string;
  note: string;
  mark: string;
  depth: number;
  /** From the top of the box. */
  y: number;
  height: number;
  details: Details;
  findings: Finding[];
}

export interface GraphNode {
  id: string;
  element: Ref | "";
  key: LayoutKey;
  kind: string;
  title: string;
  subtitle: string[];
  group: string;
  column: number;
  details: Details;
  findings: Finding[];
  x: number;
  y: number;
  width: number;
  height: number;
  /** Height of what stands above the rows. */
  head: number;
  /** Its place is the user's, not the layout's. */
  moved: boolean;
  ports: GraphPort[];
}

export interface GraphGroup {
  id: string;
  element: Ref | "";
  key: LayoutKey;
  kind: string;
  title: string;
  parent: string;
  x: number;
  y: number;
  width: number;
  height: number;
}

export interface GraphEnd {
  node: string;
  port: string;
}

export interface GraphEdge {
  id: string;
  element: Ref | "";
  key: LayoutKey;
  source: GraphEnd;
  target: GraphEnd;
  kind: string;
  title: string;
  labels: string[];
  count: number;
  details: Details;
  findings: Finding[];
  /** A start, then three points for each cubic Bezier curve; empty for none. */
  route: Point[];
  /** The middle of its label. */
  label: Point | null;
}

export interface Graph {
  view: string;
  title: string;
  /** What it shows; empty for the whole model. */
  element: Ref | "";
  downwards: boolean;
  width: number;
  height: number;
  findings: Finding[];
  nodes: GraphNode[];
  groups: GraphGroup[];
  edges: GraphEdge[];
}

export interface ViewResult {
  revision: number;
  graph: Graph;
}

// Forms, palette, connecting -----------------------------------------------------------------

export type FieldKind =
  | "text"
  | "multiline"
  | "number"
  | "integer"
  | "boolean"
  | "choice"
  | "reference";

export interface Choice {
  value: string;
  label: string;
  documentation: string;
}

export interface FormField {
  feature: string;
  label: string;
  kind: FieldKind;
  many: boolean;
  required: boolean;
  values: string[];
  /** Labels of references. */
  shown: string[];
  default: string;
  documentation: string;
  unit: string;
  choices: Choice[];
  problems: string[];
  changeable: boolean;
}

export interface ChildKind {
  kind: string;
  label: string;
  documentation: string;
  /** What a new one begins with, such as a name that nobody has. */
  values?: Record<string, string[]>;
}

export interface FormChildren {
  feature: string;
  label: string;
  many: boolean;
  documentation: string;
  kinds: ChildKind[];
  elements: { element: Ref; label: string; kind: string }[];
}

export interface Form {
  element: Ref;
  class: string;
  title: string;
  documentation: string;
  readonly: boolean;
  owner: Ref | "";
  fields: FormField[];
  children: FormChildren[];
}

export type PaletteGroup = "components" | "services" | "ros types" | "ready maps" | "elements";

export interface PaletteItem {
  id: string;
  group: PaletteGroup;
  label: string;
  note: string;
  documentation: string;
  drop: { commands: Command[] };
  label_of_edit: string;
}

export interface ConnectOption {
  label: string;
  why: string;
  /** The statement in ros2jaus. */
  preview: string;
  commands: Command[];
  is_best: boolean;
}

export interface ConnectResult {
  options: ConnectOption[];
  refusal: string;
}

export interface LegalEnd {
  node: string;
  port: string;
  label: string;
  why: string;
}

// Problems -----------------------------------------------------------------------------------

export interface Cure {
  label: string;
  commands: Command[];
}

export interface Problem {
  file: string;
  line: number;
  column: number;
  severity: Severity;
  rule: string;
  message: string;
  hint: string;
  element: Ref | "";
  /** Element path by names. */
  path: string;
  cures: Cure[];
}

export interface Problems {
  revision: number;
  elapsed_ms: number;
  files: string[];
  problems: Problem[];
}

// Sources, trying, planning ------------------------------------------------------------------

/** Where an element stands: units of UTF-16, with one for each end of a line. */
export interface Source {
  file: string;
  notation: "xmi" | "text";
  start: number;
  end: number;
  line: number;
  revision: number;
}

export interface FileText {
  text: string;
  revision: number;
  editable: boolean;
}

export interface MapMember {
  path: string;
  label: string;
  /** Type, unit and range. */
  note: string;
  mark: string;
  depth: number;
}

/** All members of one end of a map; the graph has only those of interest. */
export interface MapSide {
  /** Id of the box in the graph. */
  node: string;
  members: MapMember[];
}

export type Direction = "to_ros" | "to_jaus";

/** What fills a map. */
export interface Filling {
  label: string;
  commands: Command[];
  /** The assignments as texts write them. */
  statements: string[];
  /** Members that nothing fills then. */
  left: Partial<Record<Direction, string[]>>;
  refusal: string;
}

export interface TriedInput {
  path: string;
  type: string;
  unit: string;
  default: string;
}

export interface TryResult {
  values: { path: string; value: string; unit: string }[];
  bytes: string;
  error: string;
  /** What was done to values that do not fit. */
  notes: string[];
}

export type PlanAction = "create" | "change" | "keep" | "same" | "remove" | "refuse";

export interface Plan {
  out: string;
  files: { path: string; action: PlanAction; reason: string }[];
  drift: { path: string; line: number; severity: Severity; message: string; stub: string }[];
  problems: string;
  digest: string;
}

// Live ---------------------------------------------------------------------------------------

export interface LiveEdge {
  level: string;
  rate: number | null;
  declared: number | null;
  age: number | null;
  latency: Record<string, number> | null;
  drops: Record<string, number>;
  text: string;
}

export interface LiveBox {
  level: string;
  state: string;
  controller: string;
  text: string;
}

/** What is known of a connection, as `jausml top --json` tells it. */
export interface LiveConnection {
  bridge: string;
  connection: string;
  /** Id of its row in the system view, empty where the model has none. */
  row: string;
  level: string;
  state: string | null;
  reason: string;
  rate: number | null;
  declared_rate: number | null;
  age: number | null;
  latency_us: Record<string, number>;
  drops: Record<string, number>;
  /** Seconds since its bridge told something. */
  told: number | null;
}

export interface LiveComponent {
  id: string;
  name: string;
  level: string;
  reason: string;
  state: string | null;
  controller: string | null;
  authority: number | null;
  round_trip_ms: number | null;
}

export interface LiveState {
  health?: string;
  heard?: boolean;
  sources?: Record<string, string>;
  connections?: LiveConnection[];
  components?: LiveComponent[];
  ignored?: number;
  /** By id of an edge or a port of the system view. */
  edges: Record<string, LiveEdge>;
  /** By id of a node of the system view. */
  boxes: Record<string, LiveBox>;
}

export interface LiveMessage {
  jaus: string;
  ros: string;
  age: number | null;
}

// Methods ------------------------------------------------------------------------------------

/** Requests: parameters and results by method. */
export interface Methods {
  hello: [{ token: string }, Project];
  views: [{ file: string }, { views: ViewInfo[] }];
  view: [{ file: string; view: string }, ViewResult];
  arrange: [{ file: string; view: string }, ViewResult];
  edit: [{ commands: Command[]; label: string; base?: number; dry?: boolean }, EditResult];
  undo: [Record<string, never>, { revision: number; entry: Entry | null }];
  redo: [Record<string, never>, { revision: number; entry: Entry | null }];
  log: [Record<string, never>, { entries: Entry[]; at: number }];
  copy: [{ elements: Ref[] }, { commands: Command[] }];
  paste: [{ owner: Ref; commands: Command[] }, EditResult];
  form: [{ element: Ref }, Form];
  palette: [
    { file: string; query: string; kinds?: string[]; limit?: number },
    { items: PaletteItem[] },
  ];
  connect: [{ file: string; view: string; source: GraphEnd; target: GraphEnd }, ConnectResult];
  ends: [{ file: string; view: string; node: string; port: string }, { ends: LegalEnd[] }];
  /** How a line is taken away that is no element. */
  unlink: [{ file: string; view: string; line: string }, ConnectResult];
  problems: [{ file: string }, Problems];
  source: [{ element: Ref }, Source];
  text: [{ file: string }, FileText];
  /** The innermost element whose text has the character at an offset of a file. */
  at: [{ file: string; offset: number }, { element: Ref | "" }];
  members: [{ file: string; view: string }, { sides: MapSide[] }];
  /** How a member of a map may be filled without a source. */
  fill: [
    { file: string; view: string; target: GraphEnd; value: string },
    { constant: ConnectResult; clock: ConnectResult; ignore: ConnectResult },
  ];
  /** What nothing fills yet in a map, and what corresponds to it. */
  fill_map: [{ file: string; view: string }, Filling];
  write: [{ file: string; text: string; base: number }, { revision: number }];
  try: [
    { file: string; map: string; direction: Direction; values: Record<string, string> },
    TryResult,
  ];
  tried: [{ file: string; map: string; direction: Direction }, { inputs: TriedInput[] }];
  /** `force` overwrites generated files that were edited, after a copy. */
  plan: [{ file: string; out?: string; force?: boolean }, Plan];
  diff: [{ file: string; out: string; path: string; force: boolean }, { diff: string }];
  generate: [
    { file: string; out: string; digest: string; force: boolean },
    { written: number; message: string },
  ];
  "live.start": [{ file: string }, unknown];
  "live.stop": [Record<string, never>, unknown];
  "live.message": [{ connection: string }, LiveMessage];
}

export type Method = keyof Methods;
export type Params<M extends Method> = Methods[M][0];
export type Result<M extends Method> = Methods[M][1];

/** Notifications of the server: parameters by method. */
export interface Notifications {
  changed: { revision: number; files: FileInfo[]; entry?: Entry | null; by: "edit" | "outside" };
  problems: Problems;
  /** Another program changed a file while there were changes here that it does not have. */
  conflict: { file: string; diff: string };
  /** Another program changed a file. */
  outside: { file: string; diff: string };
  live: { state: LiveState };
}

export type Notification = keyof Notifications;
