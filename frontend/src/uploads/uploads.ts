import { useSyncExternalStore } from "react";
import { stackComplete } from "../client";
import type { Document } from "../forms/document";
import { apiUrl } from "../platform/base";
import { NAMED_ROLES, type Sorted } from "./sorting";
import { type Item, Upload, type UploadState } from "./Upload";

/** Uploads that go on while the person looks at other pages, by experiment. */
const uploads = new Map<string, Upload>();
const listeners = new Set<() => void>();

function changed(): void {
  for (const listener of listeners) listener();
}

/**
 * Everything of `sorted` that is sent: first what the description names, under the name it gives, then the frames.
 * Files that the server has already, by name and size, are left out.
 */
export function itemsOf(
  sorted: Sorted,
  document: Document,
  already: ReadonlyMap<string, number> = new Map(),
): Item[] {
  const named = NAMED_ROLES.flatMap((role) => {
    const [found, name] = [sorted.named[role], document[role]];
    return found && typeof name === "string" ? [{ file: found.file, name, role }] : [];
  });
  const frames = sorted.frames.map((found) => ({ ...found, role: "frames" as const }));
  return [...named, ...frames].filter(({ file, name }) => already.get(name) !== file.size);
}

/** Begin to send; the experiment's page shows how it goes. */
export function startUpload(experimentId: string, items: Item[]): void {
  uploads.get(experimentId)?.stop();
  const upload = new Upload(items, {
    urlOf: ({ name, role }) => apiUrl(["experiments", experimentId, "files"], { name, role }),
    close: () => stackComplete({ path: { experiment_id: experimentId } }),
  });
  uploads.set(experimentId, upload);
  changed();
  void upload.run();
}

/** Send what a failed upload left over; a file that the server will never take is left out. */
export function resumeUpload(experimentId: string): void {
  startUpload(experimentId, uploads.get(experimentId)?.unsent() ?? []);
}

export function forgetUpload(experimentId: string): void {
  uploads.get(experimentId)?.stop();
  uploads.delete(experimentId);
  changed();
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
