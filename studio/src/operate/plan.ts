// Positions on a plan: metres, up and right of the page.

export interface Point {
  up: number;
  right: number;
}

/** A report of poses, and how its numbers become metres. */
export interface Frame {
  report: string;
  paths: [string, string];
  title: string;
  pointOf(first: number, second: number, origin: [number, number]): Point;
}

/** Metres of one degree of latitude, on a sphere with the mean radius of the Earth. */
const METRES = (6_371_008.8 * Math.PI) / 180;

/** Poses of JAUS (AS6009): the local frame is that of the vehicle, x up and y right of the page. */
export const FRAMES: readonly Frame[] = [
  {
    report: "ReportLocalPose",
    paths: ["X", "Y"],
    title: "x up, y right, in the frame that the vehicle has chosen",
    pointOf: (up, right) => ({ up, right }),
  },
  {
    report: "ReportGlobalPose",
    paths: ["Latitude", "Longitude"],
    title: "north up, from the first position",
    pointOf: (latitude, longitude, [north, east]) => ({
      up: (latitude - north) * METRES,
      right: (longitude - east) * METRES * Math.cos((north * Math.PI) / 180),
    }),
  },
];

/** The values of two numbers of the same reports, in their order. */
export function paired(
  one: { times: number[]; values: number[] },
  other: { times: number[]; values: number[] },
): [number, number][] {
  const byTime = new Map(other.times.map((time, index) => [time, other.values[index]]));
  return one.times.flatMap((time, index) => {
    const [first, second] = [one.values[index], byTime.get(time)];
    return first === undefined || second === undefined ? [] : [[first, second]];
  });
}

/** A square around points, with a margin, at least some metres wide: left, top and width. */
export function around(points: readonly Point[], least: number): [number, number, number] {
  const rights = points.map((each) => each.right);
  const downs = points.map((each) => -each.up);
  const [left, top] = [Math.min(...rights), Math.min(...downs)];
  const [width, height] = [Math.max(...rights) - left, Math.max(...downs) - top];
  const size = Math.max(least, 1.2 * Math.max(width, height));
  return [left - (size - width) / 2, top - (size - height) / 2, size];
}

/** A round length of about a quarter of a width. */
export function barOf(width: number): number {
  const power = 10 ** Math.floor(Math.log10(width / 4));
  return [5, 2, 1].map((each) => each * power).find((each) => each <= width / 4) ?? power;
}
