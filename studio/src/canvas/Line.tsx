import { type EdgeProps, getBezierPath } from "@xyflow/react";
import { memo } from "react";
import type { GraphEdge } from "../protocol";
import { edgeKey } from "../selection";
import { active, isTakenLast, useStudio } from "../store";
import { bend, type FlowEdge, middleOf, pathOf } from "./flow";
import { domId, liveClass, liveText, SIGNS, severityOf, told } from "./marks";

const LINE_HEIGHT = 13;
/** Signs of what is told while the system runs, for which the layout makes room. */
const LONGEST = 24;

/** A line: the layout's route, or one of its own where a box was moved. */
export const Line = memo(function Line(props: EdgeProps<FlowEdge>) {
  const { data, selected } = props;
  const edge = data!.edge;
  const key = edgeKey(edge.id);
  const isActive = useStudio((studio) => active(studio) === key);
  const isDim = useStudio((studio) => studio.bright !== null && !studio.bright.has(key));
  const live = useStudio((studio) => studio.live?.edges[edge.id]);
  const isTaken = useStudio((studio) => isTakenLast(studio, edge.id));
  const [path, x, y] = wayOf(props);
  const anchor = data!.isRouted ? edge.anchor : "middle";
  const severity = severityOf(edge.findings);
  const classes = ["line", edge.kind, severity, liveClass(live)];
  if (data!.isAcross) classes.push("across");
  if (selected) classes.push("chosen");
  if (isActive) classes.push("active");
  if (isDim) classes.push("dim");
  if (isTaken) classes.push("taken");
  const texts = severity ? [`${SIGNS[severity]} ${severity}`, ...edge.labels] : edge.labels;
  // What a topic carries is told where its row ends on the other side of the bridge.
  const values = live && edge.kind !== "topic" ? liveText(live) : "";
  const isCut = values.length > LONGEST;
  const said = values ? [isCut ? `${values.slice(0, LONGEST - 1)}…` : values] : [];
  // The layout made room for the other words alone: what is told now stands above them.
  const lines = [...said, ...texts];
  const width = edge.count > 1 ? Math.min(1.2 + 0.4 * edge.count, 5) : undefined;
  return (
    // biome-ignore lint/a11y/noInteractiveElementToNoninteractiveRole: a group of SVG is neither
    <g id={domId(key)} className={classes.join(" ")} role="img" aria-label={labelOf(edge)}>
      <path className="way-near" d={path} />
      <path className="way-around" d={path} />
      <path className="way" d={path} strokeWidth={width} markerEnd="url(#arrow)" />
      {lines.length > 0 && (
        <text className="way-label" textAnchor={anchor}>
          {isCut && <title>{values}</title>}
          {lines.map((text, at) => (
            <tspan
              // biome-ignore lint/suspicious/noArrayIndexKey: lines have no other name
              key={at}
              className={at < said.length ? "live-text" : ""}
              x={x}
              y={y + (at - said.length - (texts.length - 1) / 2) * LINE_HEIGHT + 3.5}
            >
              {text}
            </tspan>
          ))}
        </text>
      )}
    </g>
  );
});

function wayOf(props: EdgeProps<FlowEdge>): [path: string, x: number, y: number] {
  const { edge, isRouted } = props.data!;
  if (isRouted) {
    const middle = middleOf(edge.route);
    const [x, y] = edge.label ?? [middle?.x ?? 0, middle?.y ?? 0];
    return [pathOf(edge.route), x, y];
  }
  const { sourceX, sourceY, targetX, targetY } = props;
  if (props.sourcePosition === props.targetPosition) {
    return bend(props.sourcePosition, { x: sourceX, y: sourceY }, { x: targetX, y: targetY });
  }
  const [path, x, y] = getBezierPath({ ...props, curvature: 0.3 });
  return [path, x, y];
}

function labelOf(edge: GraphEdge): string {
  return [edge.kind, edge.title, ...edge.labels, told(edge.findings)].filter(Boolean).join(", ");
}
