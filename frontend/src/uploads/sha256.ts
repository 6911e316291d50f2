import { sha256 } from "@noble/hashes/sha2.js";
import { bytesToHex } from "@noble/hashes/utils.js";

/** Up to this size the browser's own code sums up a file at once, off this thread. */
const AT_ONCE_BYTES = 64 * 2 ** 20;
/** Larger ones, and all where the page came without TLS, go in pieces, between which the page can answer. */
const PIECE_BYTES = 2 ** 20;

/** SHA-256 of a file as the server writes it; `onRead` hears how many bytes are done. */
export async function sha256Of(
  file: Blob,
  onRead: (bytes: number) => void,
  signal: AbortSignal,
): Promise<string> {
  if (file.size <= AT_ONCE_BYTES && globalThis.crypto?.subtle) {
    const digest = await crypto.subtle.digest("SHA-256", await file.arrayBuffer());
    onRead(file.size);
    return bytesToHex(new Uint8Array(digest));
  }
  const sum = sha256.create();
  for (let start = 0; start < file.size; start += PIECE_BYTES) {
    signal.throwIfAborted();
    const piece = await file.slice(start, start + PIECE_BYTES).arrayBuffer();
    sum.update(new Uint8Array(piece));
    onRead(Math.min(start + PIECE_BYTES, file.size));
  }
  return bytesToHex(sum.digest());
}
