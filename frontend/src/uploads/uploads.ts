import { useSyncExternalStore } from "react";
import { stackComplete, uploadsGet, uploadsPlan } from "../client";
import type { Document } from "../forms/document";
import { apiUrl } from "../platform/base";
import { ProblemError } from "../platform/problem";
import { sha256Of } from "./sha256";
import { NAMED_ROLES, type Sorted } from "./sorting";
import { sendByTus } from "./tus";
import { type Item, type Means, Upload, type UploadState } from "./Upload";

/** Uploads that go on while the person looks at other pages, by experiment. */
const uploads = new Map<string, Upload>();
const listeners = new Set<() => void>();

function changed(): void {
  for (const listener of listeners) listener();
}

/** Everything of `sorted` that is to be there: what the description names, under the name it gives, and the frames. */
export function itemsOf(sorted: Sorted, document: Document): Item[] {
  const named = NAMED_ROLES.flatMap((role) => {
    const [found, name] = [sorted.named[role], document[role]];
    return found && typeof name === "string" ? [{ file: found.file, name, role }] : [];
  });
  const frames = sorted.frames.map((found) => ({ ...found, role: "frames" as const }));
  return [...named, ...frames];
}

/** Begin to send; the experiment's page shows how it goes. */
export function startUpload(experimentId: string, items: Item[]): void {
  uploads.get(experimentId)?.stop();
  const upload = new Upload(items, meansOf(experimentId));
  uploads.set(experimentId, upload);
  changed();
  void upload.run();
}

function meansOf(experimentId: string): Means {
  const path = { experiment_id: experimentId };
  return {
    plan: async (files) => (await uploadsPlan({ path, body: { files } })).data,
    send: (upload, content, tell) =>
      sendByTus(apiUrl(["experiments", experimentId, "uploads", upload.id]), content, tell),
    refusal: async ({ id }) => (await uploadsGet({ path: { ...path, upload_id: id } })).data.problem ?? null,
    sha256: sha256Of,
    close: () => stackComplete({ path }).catch(unlessClosed),
  };
}

/** An answer may be lost: the stack is complete, and what is in it was found to be what is here. */
function unlessClosed(error: unknown): void {
  if (!(error instanceof ProblemError) || error.problem.code !== "conflict.stack_closed") throw error;
}

/** Go on with a failed upload; a file that the server will never take is left out. */
export function resumeUpload(experimentId: string): void {
  startUpload(experimentId, uploads.get(experimentId)?.acceptable() ?? []);
}

export function forgetUpload(experimentId: string): void {
  uploads.get(experimentId)?.stop();
  uploads.delete(experimentId);
  changed();
}

/** Ask a server that was away at once. */
export function tryNow(experimentId: string): void {
  uploads.get(experimentId)?.tryNow();
}

export function stopUpload(experimentId: string): void {
  uploads.get(experimentId)?.stop();
}

/** How the upload of an experiment from this tab goes, if there is one. */
export function useUpload(experimentId: string): UploadState | null {
  const upload = useSyncExternalStore(
    (listener) => {
      listeners.add(listener);
      return () => listeners.delete(listener);
    },
    () => uploads.get(experimentId),
  );
  return useSyncExternalStore(upload?.subscribe ?? nothing, () => upload?.getState() ?? null);
}

function nothing(): () => void {
  return () => undefined;
}

/** Closing the tab ends an upload: the browser asks first. */
export function guardUploads(): void {
  window.addEventListener("beforeunload", (event) => {
    const isBusy = [...uploads.values()].some(
      ({ state }) => state.phase === "sending" || state.phase === "closing",
    );
    if (isBusy) event.preventDefault();
  });
}
