import type { Confirmation } from "../client";
import { formatTime } from "../platform/format";

/** Who has said that order, times and scale are right, and when. */
export function confirmedBy({ by, at }: Confirmation): string {
  return by ? `${by}, ${formatTime(at)}` : formatTime(at);
}
