import { expect, it } from "vitest";
import { endpointOf } from "./endpoints";

it("says of a stream what plays it, and why the browser does not", () => {
  const endpoint = endpointOf("rtsp://10.0.0.7:8554/front");
  expect(endpoint?.commands).toEqual([
    "ffplay 'rtsp://10.0.0.7:8554/front'",
    "gst-launch-1.0 playbin uri='rtsp://10.0.0.7:8554/front'",
  ]);
  expect(endpoint?.why).toContain("Browsers do not speak RTSP");
  expect(endpoint?.isPage).toBe(false);
  expect(endpointOf("sftp://h/f.mp4")?.commands).toEqual(["curl -O 'sftp://h/f.mp4'"]);
  expect(endpointOf("https://localhost/front")?.isPage).toBe(true);
});

it.each([
  "javascript:alert(1)",
  "data:text/html,x",
  "file:///etc/passwd",
  "rtsp://",
  "-f lavfi",
  "rtsp://h/a b",
  "rtsp://h/\\n",
  "",
])("takes %j for no address", (text) => {
  expect(endpointOf(text)).toBeUndefined();
});

it("quotes for the shell what would end a quotation", () => {
  expect(endpointOf("rtsp://h/';reboot;'")?.commands[0]).toBe(
    "ffplay 'rtsp://h/'\\'';reboot;'\\'''",
  );
});
