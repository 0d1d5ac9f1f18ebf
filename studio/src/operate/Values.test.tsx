import { render, screen, waitFor } from "@testing-library/preact";
import { expect, test } from "vitest";
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
