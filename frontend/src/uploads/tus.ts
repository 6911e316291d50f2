import { DetailedError, Upload as TusUpload } from "tus-js-client";
import { ProblemError, problemFromAnswer, UNREACHABLE } from "../platform/problem";

const REQUEST_BYTES = 64 * 2 ** 20;
/** What a network loses now and then; a server that is away for longer is left to `Patience`. */
const WAITS_MS = [0, 500, 1000, 2000];
const PASSING = new Set([0, 408, 409, 429, 500, 502, 503, 504]);
const IN_USE_STATUS = 423;
const IN_USE_WAIT_MS = 5_000;

type Sending = {
  onSent: (bytes: number) => void;
  /** Whether another tab, computer or program is sending the same bytes, so that this one waits. */
  onWaiting: (isWaiting: boolean) => void;
  signal: AbortSignal;
};

/** Send what is missing of `content` to an upload that was planned; it breaks off and goes on as often as need be. */
export async function sendByTus(url: string, content: Blob, sending: Sending): Promise<void> {
  for (;;) {
    try {
      await sendOnce(url, content, sending);
      return;
    } catch (error) {
      if (!(error instanceof ProblemError) || error.problem.status !== IN_USE_STATUS) throw error;
      sending.onWaiting(true);
      await wait(IN_USE_WAIT_MS, sending.signal);
    }
  }
}

function sendOnce(url: string, content: Blob, { onSent, onWaiting, signal }: Sending): Promise<void> {
  return new Promise((resolve, reject) => {
    const upload = new TusUpload(content, {
      uploadUrl: url,
      chunkSize: REQUEST_BYTES,
      retryDelays: WAITS_MS,
      storeFingerprintForResuming: false,
      onProgress: (bytes) => {
        onWaiting(false);
        onSent(bytes);
      },
      onShouldRetry: (error) => PASSING.has(statusOf(error)),
      onError: (error) => {
        signal.removeEventListener("abort", stop);
        reject(new ProblemError(problemOf(error)));
      },
      onSuccess: () => {
        signal.removeEventListener("abort", stop);
        onSent(content.size);
        resolve();
      },
    });
    const stop = () => {
      void upload.abort();
      reject(new DOMException("Stopped", "AbortError"));
    };
    if (signal.aborted) return stop();
    signal.addEventListener("abort", stop, { once: true });
    upload.start();
  });
}

function statusOf(error: Error): number {
  return error instanceof DetailedError ? (error.originalResponse?.getStatus() ?? 0) : -1;
}

function problemOf(error: Error) {
  const answer = error instanceof DetailedError ? error.originalResponse : null;
  return answer ? problemFromAnswer(parse(answer.getBody()), answer.getStatus()) : UNREACHABLE;
}

function parse(text: string): unknown {
  try {
    return JSON.parse(text);
  } catch {
    return null;
  }
}

export function wait(duration_ms: number, signal: AbortSignal): Promise<void> {
  return new Promise((resolve, reject) => {
    const stop = () => {
      clearTimeout(timer);
      reject(new DOMException("Stopped", "AbortError"));
    };
    const timer = setTimeout(() => {
      signal.removeEventListener("abort", stop);
      resolve();
    }, duration_ms);
    if (signal.aborted) return stop();
    signal.addEventListener("abort", stop, { once: true });
  });
}
