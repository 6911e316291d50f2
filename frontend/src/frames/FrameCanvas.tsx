import { useElementSize } from "@mantine/hooks";
import { useEffect, useMemo, useRef } from "react";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { Loading } from "../platform/QueryView";
import type { Painter } from "./pen";
import { type FrameSource, usePicture } from "./pictures";
import { type OnPick, usePointer } from "./pointer";
import { paintStamp } from "./stamp";
import { type Tone, toned } from "./tone";
import { mappingOf, type View } from "./viewport";

type FrameCanvasProps = {
  source: FrameSource;
  frame: number;
  view: View;
  onView: (view: View) => void;
  tone: Tone;
  /** Shown in place of the frame as it came. */
  picture?: ImageBitmap;
  /** Drawn over the picture; a new function is drawn anew. */
  paint?: Painter;
  /** Time and the like, written into a corner beside the scale bar. */
  stamp?: string;
  label: string;
  onShown?: (frame: number) => void;
  onPick?: OnPick;
};

/** One frame as large as its place allows, with an overlay on a second canvas; drag moves it, double click zooms. */
export function FrameCanvas({
  source,
  frame,
  view,
  onView,
  tone,
  paint,
  stamp,
  label,
  ...on
}: FrameCanvasProps) {
  const { onShown, onPick } = on;
  const { ref, width } = useElementSize();
  const dpr = window.devicePixelRatio || 1;
  const picture = usePicture(source, frame, width * dpr * view.zoom);
  const pixels = on.picture ?? picture.data;
  const shown = useMemo(() => (pixels ? toned(pixels, tone) : null), [pixels, tone]);
  const below = useRef<HTMLCanvasElement>(null);
  const above = useRef<HTMLCanvasElement>(null);
  const { columns, rows, pixel_size_um } = source;
  const height = (width * rows) / columns;
  const place = useMemo(() => ({ columns, rows, width, height }), [columns, rows, width, height]);
  const mapping = useMemo(() => mappingOf(view, place), [view, place]);
  const pointer = usePointer({ view, onView, place, onPick });

  useEffect(() => {
    const context = prepared(below.current, width, height, dpr);
    if (!context || !shown) return;
    const { scale, left, top } = mapping;
    // Past three screen pixels a grey value is shown as it is; a smoothed one would be made up.
    context.imageSmoothingEnabled = scale * dpr < 3;
    context.imageSmoothingQuality = "high";
    context.drawImage(shown, left, top, columns * scale, rows * scale);
    if (!picture.isPlaceholderData) onShown?.(frame);
  }, [shown, picture.isPlaceholderData, frame, width, height, dpr, mapping, columns, rows, onShown]);

  useEffect(() => {
    const context = prepared(above.current, width, height, dpr);
    if (!context) return;
    if (paint) {
      context.save();
      context.translate(mapping.left, mapping.top);
      paint(context, mapping.scale);
      context.restore();
    }
    paintStamp(context, { width, height, um_per_screen_px: pixel_size_um / mapping.scale, text: stamp });
  }, [paint, width, height, dpr, mapping, pixel_size_um, stamp]);

  return (
    <div
      ref={ref}
      aria-busy={picture.isFetching}
      className="frame"
      style={{ aspectRatio: `${columns} / ${rows}`, maxWidth: `calc(72vh * ${columns / rows})` }}
    >
      <div
        ref={pointer.ref}
        role="img"
        aria-label={label}
        {...pointer.handlers}
        style={{ cursor: view.zoom > 1 ? "grab" : onPick ? "crosshair" : "default" }}
      >
        <canvas ref={below} />
        <canvas ref={above} />
      </div>
      {picture.isPending && <Loading rows={1} height={height || 200} />}
      {picture.error && <ProblemAlert problem={toProblem(picture.error)} />}
    </div>
  );
}

/** A canvas cleared and sized to `width` x `height` screen pixels. */
function prepared(canvas: HTMLCanvasElement | null, width: number, height: number, dpr: number) {
  const context = canvas?.getContext("2d");
  if (!canvas || !context || width === 0) return null;
  const [columns, rows] = [Math.round(width * dpr), Math.round(height * dpr)];
  if (canvas.width !== columns) canvas.width = columns;
  if (canvas.height !== rows) canvas.height = rows;
  context.setTransform(dpr, 0, 0, dpr, 0, 0);
  context.clearRect(0, 0, width, height);
  return context;
}
