import { useElementSize } from "@mantine/hooks";
import { useEffect, useRef } from "react";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { Loading } from "../platform/QueryView";
import { type FrameSource, sideFor, usePicture } from "./pictures";

/** Draws over a frame in screen pixels; `scale` is screen pixels per image pixel. */
export type Painter = (context: CanvasRenderingContext2D, scale: number) => void;

type FrameCanvasProps = {
  source: FrameSource;
  frame: number;
  /** Drawn over the picture; a new function is drawn anew. */
  paint?: Painter;
  label: string;
  onShown?: (frame: number) => void;
};

/** One frame as large as its place allows, with an overlay on a second canvas. */
export function FrameCanvas({ source, frame, paint, label, onShown }: FrameCanvasProps) {
  const { ref, width } = useElementSize();
  const dpr = window.devicePixelRatio || 1;
  const picture = usePicture(source, frame, sideFor(Math.max(width, 1) * dpr));
  const below = useRef<HTMLCanvasElement>(null);
  const above = useRef<HTMLCanvasElement>(null);
  const height = (width * source.rows) / source.columns;

  useEffect(() => {
    const context = prepared(below.current, width, height, dpr);
    if (!context || !picture.data) return;
    context.imageSmoothingQuality = "high";
    context.drawImage(picture.data, 0, 0, width, height);
    if (!picture.isPlaceholderData) onShown?.(frame);
  }, [picture.data, picture.isPlaceholderData, frame, width, height, dpr, onShown]);

  useEffect(() => {
    const context = prepared(above.current, width, height, dpr);
    if (context && paint) paint(context, width / source.columns);
  }, [paint, width, height, dpr, source.columns]);

  return (
    <div
      ref={ref}
      aria-busy={picture.isFetching}
      className="frame"
      style={{
        aspectRatio: `${source.columns} / ${source.rows}`,
        maxWidth: `calc(72vh * ${source.columns / source.rows})`,
      }}
    >
      <div role="img" aria-label={label}>
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
