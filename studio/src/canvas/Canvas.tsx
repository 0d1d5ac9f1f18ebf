import {
  ConnectionMode,
  type EdgeChange,
  MiniMap,
  type NodeChange,
  type OnConnectEnd,
  type OnConnectStart,
  ReactFlow,
  ReactFlowProvider,
  SelectionMode,
  useReactFlow,
  useStore,
  useStoreApi,
  type Viewport,
} from "@xyflow/react";
import {
  type MouseEvent,
  useCallback,
  useEffect,
  useLayoutEffect,
  useMemo,
  useRef,
  useState,
} from "react";
import { beginDrawing, bridgesOf, connect, endDrawing, select } from "../actions";
import { useSettled } from "../answers";
import { useCanvasKeys } from "../keyboard/canvasKeys";
import { useAnswer } from "../panels/base/useAnswer";
import type { Graph } from "../protocol";
import { edgeKey, groupKey, type PartKey, partOf } from "../selection";
import { active, state, update, useStudio } from "../store";
import { Box, Loads } from "./Box";
import { useDragging, useDropping } from "./dragging";
import { EmptyHint, Nothing } from "./EmptyHint";
import { Frame } from "./Frame";
import {
  edgesWithStates,
  type FlowEdge,
  type FlowNode,
  keyOfNode,
  type Moved,
  NOTHING_MOVED,
  portOfHandle,
  toEdges,
  toNodes,
  withStates,
} from "./flow";
import { Line } from "./Line";
import { useLevels } from "./levels";
import { domId } from "./marks";
import { areaOf } from "./navigation";
import { FEW_BOXES, Tools, type ToolsProps } from "./Tools";
import { useFewAtOnce } from "./turns";

// Outside the component: React Flow draws everything anew when these change.
const NODE_TYPES = { box: Box, frame: Frame };
const EDGE_TYPES = { line: Line };
const MANY_BOXES = 100;
/** Below this zoom labels cannot be read, and are not drawn. */
const FAR = 0.45;
const FIT = { padding: 0.05, maxZoom: 1.2 } as const;
/** Zoom at which a box is shown that was asked for by name. */
const READABLE = 0.7;

/** The diagram of the chosen view. */
export function Canvas() {
  const graph = useStudio((studio) => studio.graph);
  const fault = useStudio((studio) => studio.graphFault);
  const visits = useStudio((studio) => studio.visits);
  const [hasMap, setHasMap] = useState(true);
  const loads = useLoads(graph);
  if (!graph) return fault ? <p className="quiet">{fault}</p> : <Nothing />;
  return (
    <ReactFlowProvider key={visits}>
      <Loads value={loads}>
        <Diagram graph={graph} hasMap={hasMap} onMap={setHasMap} />
      </Loads>
    </ReactFlowProvider>
  );
}

function Diagram({ graph, hasMap, onMap }: ToolsProps) {
  const selection = useStudio((studio) => studio.selection);
  const chosen = useMemo(() => new Set(selection), [selection]);
  const [moved, setMoved] = useMoved(graph);
  const boxes = useMemo(() => toNodes(graph), [graph]);
  const lines = useMemo(() => toEdges(graph), [graph]);
  const all = useMemo(() => withStates(boxes, moved, chosen), [boxes, moved, chosen]);
  const nodes = useFewAtOnce(all);
  const edges = useMemo(
    () => edgesWithStates(graph, lines, moved, chosen),
    [graph, lines, moved, chosen],
  );
  const isWhole = useStore(({ transform: [x, y, zoom], width, height }) => {
    const isInside = x + graph.width * zoom <= width && y + graph.height * zoom <= height;
    return isInside && x >= 0 && y >= 0;
  });
  const isFar = useStore((flow) => flow.transform[2] < FAR);
  const here = useStudio(active);
  const keys = useCanvasKeys(graph, setMoved);
  const drawing = useDrawing();
  const dragging = useDragging(graph, setMoved);
  const dropping = useDropping(graph);
  const isFitted = useFitted();
  useInSight(graph, here, isFitted);
  useLevels(graph);
  const diagram = useToldZoom();

  const onNodesChange = useCallback(
    (changes: NodeChange<FlowNode>[]) => {
      dragging.onMoved(changes);
      takeSelection(changes, (id) => {
        const node = boxes.find((box) => box.id === id);
        return node ? keyOfNode(node) : null;
      });
    },
    [boxes, dragging.onMoved],
  );
  const onEdgesChange = useCallback((changes: EdgeChange<FlowEdge>[]) => {
    takeSelection(changes, edgeKey);
  }, []);

  function onClick(event: MouseEvent) {
    const key = (event.target as Element).closest<HTMLElement>("[data-part]")?.dataset.part;
    if (!key || partOf(key).of === "node") return;
    const { selection } = state();
    const isMore = event.ctrlKey || event.metaKey || event.shiftKey;
    if (!isMore) select([key]);
    else if (selection.includes(key)) select(selection.filter((other) => other !== key));
    else select([...selection, key]);
  }

  return (
    <div
      ref={diagram}
      className={`diagram ${isFar ? "far" : ""} ${graph.crowded ? "crowded" : ""} ${isFitted ? "" : "unfitted"}`}
    >
      <Tools graph={graph} hasMap={hasMap} onMap={onMap} />
      <ReactFlow
        className="flow"
        nodes={nodes}
        edges={edges}
        nodeTypes={NODE_TYPES}
        edgeTypes={EDGE_TYPES}
        onNodesChange={onNodesChange}
        onEdgesChange={onEdgesChange}
        onNodeClick={onClick}
        onNodeDrag={(event, _, dragged) => dragging.onDrag(event, dragged)}
        onNodeDragStop={(event, _, dragged) => void dragging.onDragStop(event, dragged)}
        onSelectionDrag={(event, dragged) => dragging.onDrag(event, dragged)}
        onSelectionDragStop={(event, dragged) => void dragging.onDragStop(event, dragged)}
        onPaneClick={() => select([])}
        onMoveEnd={(_, { x, y, zoom }) => isFitted && update({ sight: [x, y, zoom] })}
        onConnectStart={drawing.onStart}
        onConnectEnd={drawing.onEnd}
        onDragOver={dropping.onDragOver}
        onDragLeave={dropping.onDragLeave}
        onDrop={(event) => void dropping.onDrop(event)}
        connectionMode={ConnectionMode.Loose}
        connectionRadius={24}
        selectionMode={SelectionMode.Partial}
        multiSelectionKeyCode={["Control", "Meta", "Shift"]}
        selectionKeyCode="Shift"
        deleteKeyCode={null}
        disableKeyboardA11y
        nodesFocusable={false}
        edgesFocusable={false}
        zoomOnDoubleClick={false}
        onlyRenderVisibleElements={graph.nodes.length > MANY_BOXES}
        minZoom={leastZoom(graph)}
        maxZoom={3}
        tabIndex={0}
        aria-label={`Diagram of ${graph.title || graph.view}`}
        aria-activedescendant={here ? domId(here) : undefined}
        aria-keyshortcuts="? F2 Delete c"
        onKeyDown={keys}
        proOptions={{ hideAttribution: false }}
      >
        <svg className="definitions" aria-hidden="true">
          <defs>
            <marker
              id="arrow"
              viewBox="0 0 8 8"
              refX="8"
              refY="4"
              markerWidth="8"
              markerHeight="8"
              markerUnits="userSpaceOnUse"
              orient="auto"
            >
              <path d="M0 0.8 8 4 0 7.2z" fill="context-stroke" />
            </marker>
          </defs>
        </svg>
        {hasMap && graph.nodes.length > FEW_BOXES && !isWhole && (
          <MiniMap pannable zoomable ariaLabel="Map of the diagram" nodeClassName={classInMap} />
        )}
      </ReactFlow>
      {graph.nodes.length === 0 && <EmptyHint />}
    </div>
  );
}

/** Milliseconds without an edit after which the bridges are weighed. */
const REST_MS = 500;
const NO_LOADS = {};

/** What the bridges of a system cost. */
function useLoads(graph: Graph | null): Record<string, string> {
  const file = useStudio((studio) => studio.file);
  const revision = useSettled(
    useStudio((studio) => `${studio.revision}`),
    REST_MS,
  );
  const isAsked = graph?.view === "system" && bridgesOf(graph).length > 0;
  return useAnswer("loads", isAsked ? { file } : null, revision).value?.loads ?? NO_LOADS;
}

const classInMap = (node: FlowNode): string =>
  node.type === "frame" ? "in-map frame" : `in-map ${node.data.node.kind}`;

/** A zoom at which the whole can be seen, also in a small window. */
function leastZoom(graph: Graph): number {
  return Math.min(0.05, 150 / Math.max(graph.width, graph.height, 1));
}

/** Places of boxes while they are moved; a new graph has them itself. */
function useMoved(graph: Graph) {
  const [moved, setMoved] = useState<Moved>(NOTHING_MOVED);
  const [shown, setShown] = useState(graph);
  if (shown !== graph) {
    setShown(graph);
    setMoved(NOTHING_MOVED);
  }
  return [shown === graph ? moved : NOTHING_MOVED, setMoved] as const;
}

/** Drawing a line from row to row: shows where it may end, and asks how to connect. */
function useDrawing() {
  const onStart = useCallback<OnConnectStart>((_, { nodeId, handleId }) => {
    if (nodeId) void beginDrawing({ node: nodeId, port: portOfHandle(handleId) });
  }, []);
  const onEnd = useCallback<OnConnectEnd>((event, { fromNode, fromHandle, toNode, toHandle }) => {
    endDrawing();
    if (!fromNode) return;
    // What is below the pointer is meant, and not the end that is nearest, which may be another row's.
    const near = toNode && { node: toNode.id, port: portOfHandle(toHandle?.id) };
    const target = endBelow(event) ?? near;
    if (target) {
      void connect({ node: fromNode.id, port: portOfHandle(fromHandle?.id) }, target);
    }
  }, []);
  return { onStart, onEnd };
}

/** The row or box below the pointer or finger. */
function endBelow(event: globalThis.MouseEvent | TouchEvent) {
  const at = "changedTouches" in event ? event.changedTouches[0] : event;
  if (!at) return null;
  const parts = document.elementsFromPoint(at.clientX, at.clientY).flatMap((element) => {
    const key = element.closest<HTMLElement>("[data-part]")?.dataset.part;
    return key ? [partOf(key)] : [];
  });
  // Ends of the box lie on its rows.
  const part = parts.find(({ of }) => of === "port") ?? parts.find(({ of }) => of === "node");
  if (part?.of === "port") return { node: part.node, port: part.id };
  return part?.of === "node" ? { node: part.id, port: "" } : null;
}

function takeSelection(
  changes: (NodeChange<FlowNode> | EdgeChange<FlowEdge>)[],
  keyOf: (id: string) => PartKey | null,
): void {
  let { selection } = state();
  const before = selection;
  for (const change of changes) {
    if (change.type !== "select") continue;
    const key = keyOf(change.id);
    if (!key || selection.includes(key) === change.selected) continue;
    selection = change.selected
      ? [...selection.filter((chosen) => partOf(chosen).of !== "port"), key]
      : selection.filter((chosen) => chosen !== key);
  }
  if (selection !== before) select(selection);
}

/**
 * Shows all as soon as there is room, and tells when that is done: until then nobody shall take
 * hold of what moves. By itself React Flow fits what it has measured, and it measures nothing here.
 * What shows all goes on doing so when its room changes, until somebody looks at a part, or did so
 * before the page was loaded again.
 */
function useFitted(): boolean {
  const flow = useReactFlow();
  const hasRoom = useStore((store) => store.panZoom !== null && store.width > 0);
  const room = useStore((store) => `${store.width} ${store.height}`);
  const [isFitted, setFitted] = useState(false);
  const fitted = useRef<Viewport | null>(null);
  const fits = useStudio((studio) => studio.fits);
  const asked = useRef(fits);
  // biome-ignore lint/correctness/useExhaustiveDependencies: it fits anew when its room changes
  useEffect(() => {
    const { sight } = state();
    const isAsked = asked.current !== fits;
    asked.current = fits;
    if (!hasRoom) return;
    if (!fitted.current && sight) {
      const [x, y, zoom] = sight;
      fitted.current = { x, y, zoom: 0 }; // not the whole
      void flow.setViewport({ x, y, zoom }).then(() => setFitted(true));
    } else if (isAsked || !fitted.current || isSame(fitted.current, flow.getViewport())) {
      void flow.fitView(FIT).then(() => {
        fitted.current = flow.getViewport();
        update({ sight: null });
        setFitted(true);
      });
    }
  }, [flow, hasRoom, room, fits]);
  return isFitted;
}

const isSame = (one: Viewport, other: Viewport): boolean =>
  one.x === other.x && one.y === other.y && one.zoom === other.zoom;

/** Steps of zoom in each doubling of it. */
const STEPS = 3;

/**
 * Tells the style sheet the zoom, in steps: what closed frames tell is as large far away as near, and
 * is laid out anew only where that can be seen.
 */
function useToldZoom() {
  const flow = useStoreApi();
  const diagram = useRef<HTMLDivElement>(null);
  useLayoutEffect(() => {
    let latest = 0;
    const tell = ({ transform }: { transform: [number, number, number] }) => {
      const zoom = Math.min(2 ** (Math.round(Math.log2(transform[2]) * STEPS) / STEPS), 1);
      if (zoom !== latest) diagram.current?.style.setProperty("--zoom", zoom.toFixed(4));
      latest = zoom;
    };
    tell(flow.getState());
    return flow.subscribe(tell);
  }, [flow]);
  return diagram;
}

/** Brings what the keyboard chose into sight, where it is not. */
function useInSight(graph: Graph, here: PartKey | null, isFitted: boolean) {
  const flow = useReactFlow();
  const width = useStore((store) => store.width);
  const height = useStore((store) => store.height);
  // What was chosen before the page was loaded again may lie aside.
  const last = useRef<PartKey | null>(state().sight ? here : null);
  const centre = useStudio((studio) => studio.centre);
  useEffect(() => {
    if (!centre || !isFitted) return;
    update({ centre: null });
    void flow.setCenter(...centre, { zoom: Math.max(flow.getZoom(), READABLE), duration: 0 });
  }, [centre, isFitted, flow]);
  useEffect(() => {
    if (!here || here === last.current || !width) return;
    last.current = here;
    const area = areaOf(graph, here);
    if (!area || here === groupKey("")) return;
    const { x, y, zoom } = flow.getViewport();
    const [left, top] = [area.x * zoom + x, area.y * zoom + y];
    const [right, bottom] = [left + area.width * zoom, top + area.height * zoom];
    const isSeen = right > 40 && left < width - 40 && bottom > 30 && top < height - 30;
    if (isSeen) return;
    const still = window.matchMedia("(prefers-reduced-motion: reduce)").matches;
    void flow.setCenter(area.x + area.width / 2, area.y + area.height / 2, {
      zoom,
      duration: still ? 0 : 200,
    });
  }, [graph, here, width, height, flow]);
}
