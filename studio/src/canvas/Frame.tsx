import type { NodeProps } from "@xyflow/react";
import { memo } from "react";
import { groupKey } from "../selection";
import { active, isPresent, useStudio } from "../store";
import type { FrameNode } from "./flow";
import { domId, liveClass, liveText } from "./marks";

/** A frame around boxes: a host, a bridge, a service, a state. */
export const Frame = memo(function Frame({ data, selected }: NodeProps<FrameNode>) {
  const { group } = data;
  const key = groupKey(group.id);
  const isActive = useStudio((studio) => active(studio) === key);
  const isUnder = useStudio((studio) => studio.under === key);
  const isNow = useStudio((studio) => isPresent(studio, group.id, true));
  const live = useStudio((studio) => studio.live?.boxes[group.id]);
  const states = [
    isNow && "now",
    liveClass(live),
    selected && "chosen",
    isActive && "active",
    isUnder && "under",
  ];
  return (
    // biome-ignore lint/a11y/useSemanticElements: the diagram is one application with parts
    <div
      id={domId(key)}
      className={["frame", group.kind, ...states].filter(Boolean).join(" ")}
      role="group"
      aria-label={`${group.kind} ${group.title}`}
      data-part={key}
      style={{ width: group.width, height: group.height }}
    >
      <span className="title">{group.title}</span>
      {live && (
        <span className="live-text" title={liveText(live)}>
          {liveText(live)}
        </span>
      )}
    </div>
  );
});
