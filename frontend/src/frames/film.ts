import { drawScene, type Scene } from "./drawing";

export type FilmOptions = {
  first: number;
  last: number;
  frames_per_s: number;
  sceneOf: (frame: number) => Promise<Scene>;
  onProgress: (n_done: number) => void;
  signal: AbortSignal;
};

/** Browsers offer video encoders only to pages from this machine or with HTTPS. */
export function canFilm(): boolean {
  return typeof VideoEncoder !== "undefined";
}

/** Frames `first` to `last` as they are seen, with everything drawn over them, as MP4. */
export async function filmAsMp4(options: FilmOptions): Promise<Blob> {
  const { first, last, frames_per_s, sceneOf, onProgress, signal } = options;
  const {
    BufferTarget,
    CanvasSource,
    getFirstEncodableVideoCodec,
    Mp4OutputFormat,
    Output,
    QUALITY_VERY_HIGH,
  } = await import("mediabunny");
  const canvas = await drawScene(await sceneOf(first), document.createElement("canvas"), true);
  const format = new Mp4OutputFormat();
  const { width, height } = canvas;
  const codec = await getFirstEncodableVideoCodec(format.getSupportedVideoCodecs(), { width, height });
  if (!codec) throw new Error("This browser has no video encoder that MP4 can hold.");
  const output = new Output({ format, target: new BufferTarget() });
  // Thin circles over grey are what codecs blur first.
  const track = new CanvasSource(canvas, { codec, bitrate: QUALITY_VERY_HIGH });
  output.addVideoTrack(track, { frameRate: frames_per_s });
  await output.start();
  for (let frame = first; frame <= last; frame++) {
    if (signal.aborted) {
      await output.cancel();
      throw new DOMException("The film was stopped.", "AbortError");
    }
    await drawScene(await sceneOf(frame), canvas, true);
    await track.add((frame - first) / frames_per_s, 1 / frames_per_s);
    onProgress(frame - first + 1);
  }
  await output.finalize();
  return new Blob([output.target.buffer as ArrayBuffer], { type: "video/mp4" });
}
