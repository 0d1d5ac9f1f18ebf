import { render, screen, waitFor } from "@testing-library/preact";
import { expect, test } from "vitest";
import { Plan } from "./Plan";
import type { Values } from "./protocol";
import { setCaller, useUnit } from "./unit";
import { ValuesPanel } from "./Values";

test("reports that the unit learns later are offered without choosing the component again", async () => {
  const reports = [{ name: "ReportLocalPose", service: "LocalPoseSensor" }];
  setCaller({
    call: async (method) =>
      method === "messages" ? { services: [], commands: [], reports } : { values: [] },
  });
  useUnit.setState({ chosen: "1.1.1" });
  render(<ValuesPanel />);
  await screen.findByRole("option", { name: "ReportLocalPose" });
  reports.push({ name: "ReportVelocityState", service: "VelocityStateSensor" });
  useUnit.setState({ learnt: 1 });
  await waitFor(() => expect(screen.getByText("ReportVelocityState")).toBeInTheDocument());
});

test("a place that was told long ago is told to be old", async () => {
  setCaller({ call: async () => ({ times: [10, 20], values: [1, 2], now: 80, epoch: 0 }) });
  render(<Plan values={[{ component: "1.1.1", report: "ReportLocalPose" } as Values]} />);
  expect(await screen.findByText("1.1.1 ✝ 60 s old")).toBeInTheDocument();
});
