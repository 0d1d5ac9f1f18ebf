// Pictures for documents: the whole view, as `jausml diagram` draws it.

import { state } from "../store";
import { ask, tried } from "./asking";

export type PictureFormat = "svg" | "png";

const SVG = "image/svg+xml;charset=utf-8";
/** Dots for each pixel, and dots of a picture at most: of more, browsers make nothing. */
const ZOOM = 2;
const MOST_DOTS = 64_000_000;

/** Saves the view that is shown as a file of the user. */
export async function exportPicture(format: PictureFormat): Promise<void> {
  const { file, view } = state();
  const answer = await tried(ask("picture", { file, view }));
  if (!answer) return;
  const svg = new Blob([answer.picture], { type: SVG });
  const image = format === "svg" ? svg : await tried(rasterised(answer.picture));
  if (image) save(image, `${view.replace(/\W+/g, "-")}.${format}`);
}

/** The dots of a picture, which the browser makes of its SVG. */
async function rasterised(picture: string): Promise<Blob> {
  const image = new Image();
  image.src = `data:${SVG},${encodeURIComponent(picture)}`;
  await image.decode();
  const { width, height } = image;
  const zoom = Math.min(ZOOM, Math.sqrt(MOST_DOTS / (width * height)));
  const canvas = document.createElement("canvas");
  canvas.width = Math.round(width * zoom);
  canvas.height = Math.round(height * zoom);
  canvas.getContext("2d")?.drawImage(image, 0, 0, canvas.width, canvas.height);
  const blob = await new Promise<Blob | null>((done) => canvas.toBlob(done, "image/png"));
  if (!blob) throw new Error("The browser cannot make so large a PNG: export SVG.");
  return blob;
}

function save(data: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(data);
  link.download = name;
  link.click();
  URL.revokeObjectURL(link.href);
}
