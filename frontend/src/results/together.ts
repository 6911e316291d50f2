import { useMemo, useRef } from "react";
import { type Figure, withCommonColours } from "./figure";

type Asked = { data: unknown; isPlaceholderData: boolean };
type Pair = [Figure | null, Figure | null];

/**
 * Two figures in the same colours. While one of the two is still that of the range before, so is the other:
 * both change once, together, and not each time that one of them arrives.
 */
export function useTogether(left: Asked, right: Asked): Pair {
  const last = useRef<[unknown, unknown]>([left.data, right.data]);
  const isBetween = left.isPlaceholderData || right.isPlaceholderData;
  if (!isBetween) last.current = [left.data, right.data];
  const [one, other] = last.current;
  return useMemo(
    () => withCommonColours((one ?? null) as Figure | null, (other ?? null) as Figure | null),
    [one, other],
  );
}
