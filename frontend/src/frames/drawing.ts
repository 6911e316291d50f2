import { type Painter, SvgPen } from "./pen";
import { type FrameSource, fetchPicture, wholePictureUrl } from "./pictures";
import { paintStamp } from "./stamp";
import { type Tone, toned } from "./tone";
import { mappingOf, type View } from "./viewport";

/** All that is seen of one frame, to be drawn anew as a file. */
export type Scene = Scenery & {
  source: FrameSource;
  frame: number;
  view: View;
  tone: Tone;
  stamp?: string;
};

/** What is drawn over a frame, and perhaps in place of the frame as it came. */
export type Scenery = { paint?: Painter; picture?: ImageBitmap };

const WIDTH_MIN = 1200;
const WIDTH_MAX = 4096;
const SCREEN_WIDTH = 1100;

/** What is seen of the frame at its own resolution (at least 1200 px wide); `unit` is a screen pixel of then. */
function sheetOf({ source, view }: Scene, isEven = false) {
  const seen_px = source.columns / view.zoom;
  const wanted = Math.min(WIDTH_MAX, Math.max(seen_px, WIDTH_MIN));
  const round = (value: number) => (isEven ? 2 * Math.round(value / 2) : Math.round(value));
  const width = round(wanted);
  const height = round((wanted * source.rows) / source.columns);
  return { width, height, unit: width / SCREEN_WIDTH };
}

/** Draw a scene on a canvas of its own size; video wants even sides. */
export async function drawScene(scene: Scene, canvas = document.createElement("canvas"), isEven = false) {
  const { width, height, unit } = sheetOf(scene, isEven);
  const pixels = scene.picture ?? (await fetchPicture(wholePictureUrl(scene.source, scene.frame)));
  const picture = toned(pixels, scene.tone);
  if (canvas.width !== width) canvas.width = width;
  if (canvas.height !== height) canvas.height = height;
  const context = canvas.getContext("2d");
  if (!context) throw new Error("This browser does not draw on a canvas of this size.");
  const { columns, rows, pixel_size_um } = scene.source;
  const mapping = mappingOf(scene.view, { columns, rows, width, height });
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.imageSmoothingQuality = "high";
  context.drawImage(picture, mapping.left, mapping.top, columns * mapping.scale, rows * mapping.scale);
  context.setTransform(unit, 0, 0, unit, mapping.left, mapping.top);
  scene.paint?.(context, mapping.scale / unit);
  context.setTransform(1, 0, 0, 1, 0, 0);
  const um_per_screen_px = pixel_size_um / mapping.scale;
  paintStamp(context, { width, height, um_per_screen_px, text: scene.stamp, size: 13 * unit });
  return canvas;
}

export async function sceneAsPng(scene: Scene): Promise<Blob> {
  return blobOf(await drawScene(scene), "image/png");
}

/** The picture inside as a JPEG, everything drawn over it as shapes and text that can be edited. */
export async function sceneAsSvg(scene: Scene): Promise<Blob> {
  const { width, height, unit } = sheetOf(scene);
  const plain = await drawScene({ ...scene, paint: undefined, stamp: undefined });
  const address = await asDataUrl(await blobOf(plain, "image/jpeg"));
  const { columns, rows, pixel_size_um } = scene.source;
  const mapping = mappingOf(scene.view, { columns, rows, width, height });
  const [over, stamp] = [new SvgPen(), new SvgPen()];
  scene.paint?.(over, mapping.scale / unit);
  const um_per_screen_px = pixel_size_um / mapping.scale;
  paintStamp(stamp, { width, height, um_per_screen_px, text: scene.stamp, size: 13 * unit });
  const text = `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}">
<clipPath id="seen"><rect width="${width}" height="${height}"/></clipPath>
<image href="${address}" width="${width}" height="${height}"/>
<g clip-path="url(#seen)"><g transform="translate(${mapping.left} ${mapping.top}) scale(${unit})">${over.elements.join("\n")}</g></g>
<g>${stamp.elements.join("\n")}</g>
</svg>`;
  return new Blob([text], { type: "image/svg+xml" });
}

function blobOf(canvas: HTMLCanvasElement, type: string): Promise<Blob> {
  return new Promise((resolve, reject) => {
    canvas.toBlob(
      (blob) => (blob ? resolve(blob) : reject(new Error(`No ${type} could be made.`))),
      type,
      0.92,
    );
  });
}

function asDataUrl(blob: Blob): Promise<string> {
  return new Promise((resolve, reject) => {
    const reader = new FileReader();
    reader.onload = () => resolve(String(reader.result));
    reader.onerror = () => reject(reader.error);
    reader.readAsDataURL(blob);
  });
}

/** Hand a file to the person. */
export function saveFile(blob: Blob, name: string): void {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
