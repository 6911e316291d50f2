import type { Found } from "./sorting";

/** Files of a drop, folders and all. `onFound` hears the count now and then: a folder may hold tens of thousands. */
export async function collectDrop(
  transfer: DataTransfer,
  onFound: (count: number) => void,
): Promise<Found[]> {
  // Entries must be taken before the first await: the browser empties the transfer after the event.
  const entries = [...transfer.items]
    .map((item) => item.webkitGetAsEntry())
    .filter((entry) => entry !== null);
  if (entries.length === 0) return fromList(transfer.files);
  const found: Found[] = [];
  for (const entry of entries) await walk(entry, found, onFound);
  onFound(found.length);
  return found;
}

/** Files of an `<input>`; those of a folder carry their path. */
export function fromList(files: Iterable<File>): Found[] {
  return [...files].map((file) => ({ file, name: file.webkitRelativePath || file.name }));
}

const TELL_EVERY = 200;

async function walk(entry: FileSystemEntry, found: Found[], onFound: (count: number) => void): Promise<void> {
  if (entry.isFile) {
    const file = await new Promise<File>((resolve, reject) =>
      (entry as FileSystemFileEntry).file(resolve, reject),
    );
    found.push({ file, name: entry.fullPath.replace(/^\//, "") });
    if (found.length % TELL_EVERY === 0) onFound(found.length);
    return;
  }
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  // A reader hands out a folder in parts of about a hundred, until it hands out none.
  for (;;) {
    const part = await new Promise<FileSystemEntry[]>((resolve, reject) =>
      reader.readEntries(resolve, reject),
    );
    if (part.length === 0) return;
    for (const inner of part) await walk(inner, found, onFound);
  }
}
