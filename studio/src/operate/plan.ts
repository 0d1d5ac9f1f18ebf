// Positions on a plan: metres, up and right of the page.

export interface Point {
  up: number;
  right: number;
}

/** The first and second number of a place, as its report and its waypoint have them. */
export type Place = [number, number];

/** A report of poses, its waypoints, and how their numbers become metres. */
export interface Frame {
  report: string;
  /** The message that is a waypoint of this frame. */
  waypoint: string;
  paths: [string, string];
  /** What is up and what is right on the plan. */
  axes: [string, string];
  title: string;
  /** Decimals of a place that is drawn: centimetres. */
  decimals: number;
  /** Whether the plan needs a place that it is drawn around. */
  hasOrigin: boolean;
  pointOf(first: number, second: number, origin: Place): Point;
  placeOf(point: Point, origin: Place): Place;
}

/** Half axis in metres and square of the eccentricity of WGS 84. */
const AXIS = 6_378_137;
const ECCENTRICITY_2 = 0.006_694_379_990_14;
const RADIANS = Math.PI / 180;

/** Metres of a degree of latitude and of longitude at a latitude. */
function degreesAt(latitude: number): { north: number; east: number } {
  const flattened = 1 - ECCENTRICITY_2 * Math.sin(latitude * RADIANS) ** 2;
  const across = AXIS / Math.sqrt(flattened);
  return {
    north: (RADIANS * across * (1 - ECCENTRICITY_2)) / flattened,
    east: RADIANS * across * Math.cos(latitude * RADIANS),
  };
}

/** An angle within -180 .. 180 degrees. */
const wrapped = (degrees: number): number => degrees - 360 * Math.round(degrees / 360);

/** Poses of JAUS (AS6009): the local frame is that of the vehicle, x up and y right of the page. */
export const FRAMES: readonly Frame[] = [
  {
    report: "ReportLocalPose",
    waypoint: "SetLocalWaypoint",
    paths: ["X", "Y"],
    axes: ["x", "y"],
    title: "x up, y right, in the frame that the vehicle has chosen",
    decimals: 2,
    hasOrigin: false,
    pointOf: (up, right) => ({ up, right }),
    placeOf: ({ up, right }) => [up, right],
  },
  {
    report: "ReportGlobalPose",
    waypoint: "SetGlobalWaypoint",
    paths: ["Latitude", "Longitude"],
    axes: ["north", "east"],
    title: "north up, from the first position",
    decimals: 7,
    hasOrigin: true,
    pointOf: (latitude, longitude, [north, east]) => ({
      up: (latitude - north) * degreesAt(north).north,
      right: wrapped(longitude - east) * degreesAt(north).east,
    }),
    placeOf: ({ up, right }, [north, east]) => [
      north + up / degreesAt(north).north,
      wrapped(east + right / degreesAt(north).east),
    ],
  },
];

/** Degrees of latitude beyond which a flat plan is not true. */
const POLE = 80;
/** Metres from the origin within which it is, to 2 %. */
const FARTHEST = 20_000;

/** Why a plan cannot be drawn around a place; empty where it can. */
export function refusalAround(frame: Frame, [north]: Place): string {
  return frame.hasOrigin && Math.abs(north) > POLE
    ? `Beyond ${POLE} degrees of latitude a flat plan is not true: enter numbers.`
    : "";
}

/** The place of a point that is drawn, or why it is none. */
export function placeOf(frame: Frame, point: Point, origin: Place): Place | string {
  if (frame.hasOrigin && Math.hypot(point.up, point.right) > FARTHEST)
    return `This is more than ${FARTHEST / 1000} km from where the plan was begun, and it is flat: enter numbers.`;
  const place = frame.placeOf(point, origin);
  return (
    refusalAround(frame, place) ||
    (place.map((coordinate) => Number(coordinate.toFixed(frame.decimals))) as Place)
  );
}

/** Metres along places, each leg by the scale at its beginning. */
export function lengthOf(frame: Frame, places: readonly Place[]): number {
  const legs = places.slice(1).map((place, index) => {
    const begin = places[index] as Place;
    const [from, to] = [frame.pointOf(...begin, begin), frame.pointOf(...place, begin)];
    return Math.hypot(to.up - from.up, to.right - from.right);
  });
  return legs.reduce((sum, leg) => sum + leg, 0);
}

/** The values of two numbers of the same reports, in their order. */
export function paired(
  one: { times: number[]; values: (number | null)[] },
  other: { times: number[]; values: (number | null)[] },
): Place[] {
  const byTime = new Map(other.times.map((time, index) => [time, other.values[index]]));
  return one.times.flatMap((time, index) => {
    const [first, second] = [one.values[index], byTime.get(time)];
    return first == null || second == null ? [] : [[first, second]];
  });
}

/** A square around points, with a margin, at least some metres wide: left, top and width. */
export function around(points: readonly Point[], least: number): [number, number, number] {
  const rights = points.map((point) => point.right);
  const downs = points.map((point) => -point.up);
  const [left, top] = [Math.min(...rights), Math.min(...downs)];
  const [width, height] = [Math.max(...rights) - left, Math.max(...downs) - top];
  const size = Math.max(least, 1.2 * Math.max(width, height));
  return [left - (size - width) / 2, top - (size - height) / 2, size];
}

/** A round length of about a quarter of a width. */
export function barOf(width: number): number {
  const power = 10 ** Math.floor(Math.log10(width / 4));
  return [5, 2, 1].map((digit) => digit * power).find((digit) => digit <= width / 4) ?? power;
}
