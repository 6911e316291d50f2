import type { Problem } from "../client";
import { ProblemError, problemFromAnswer, UNREACHABLE } from "../platform/problem";

/** With waits that double from half a second: a server that restarts is back before the last. */
const TRIES = 6;

/** Whether the same bytes may succeed a moment later: no answer, an overloaded or failing server. */
export function isPassing(problem: Problem): boolean {
  return problem.status === 0 || problem.status === 408 || problem.status === 429 || problem.status >= 500;
}

/** PUT one file, again after a passing failure; `onSent` hears how many of its bytes are gone. */
export async function sendFile(
  url: string,
  file: Blob,
  onSent: (bytes: number) => void,
  signal: AbortSignal,
  firstWait_ms: number,
): Promise<void> {
  for (let attempt = 1; ; attempt += 1) {
    try {
      await put(url, file, onSent, signal);
      return;
    } catch (error) {
      onSent(0);
      const isLast = attempt === TRIES || signal.aborted;
      if (isLast || !(error instanceof ProblemError) || !isPassing(error.problem)) throw error;
      await wait(firstWait_ms * 2 ** (attempt - 1), signal);
    }
  }
}

/** XMLHttpRequest, since fetch does not tell how far an upload is. */
function put(url: string, file: Blob, onSent: (bytes: number) => void, signal: AbortSignal): Promise<void> {
  return new Promise((resolve, reject) => {
    const request = new XMLHttpRequest();
    const abort = () => request.abort();
    request.open("PUT", url);
    request.setRequestHeader("Content-Type", "application/octet-stream");
    request.upload.onprogress = (event) => onSent(event.loaded);
    request.onload = () => {
      if (request.status < 300) {
        onSent(file.size);
        resolve();
      } else
        reject(
          new ProblemError(
            problemFromAnswer(parse(request.responseText), request.status, request.statusText),
          ),
        );
    };
    request.onerror = () => reject(new ProblemError(UNREACHABLE));
    request.onabort = () => reject(new DOMException("Stopped", "AbortError"));
    request.onloadend = () => signal.removeEventListener("abort", abort);
    signal.addEventListener("abort", abort);
    request.send(file);
  });
}

function parse(text: string): unknown {
  try {
    return JSON.parse(text);
  } catch {
    return null;
  }
}

function wait(duration_ms: number, signal: AbortSignal): Promise<void> {
  return new Promise((resolve, reject) => {
    const stop = () => {
      clearTimeout(timer);
      reject(new DOMException("Stopped", "AbortError"));
    };
    const timer = setTimeout(() => {
      signal.removeEventListener("abort", stop);
      resolve();
    }, duration_ms);
    signal.addEventListener("abort", stop, { once: true });
  });
}
