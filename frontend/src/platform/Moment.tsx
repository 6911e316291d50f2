import { useInterval } from "@mantine/hooks";
import { useEffect, useState } from "react";
import { formatAgo, formatTime } from "./format";

const REFRESH_MS = 30_000;

/** A time relative to now; the absolute one beside it, or on hover where room is short. */
export function Moment({ time, isShort = false }: { time: string; isShort?: boolean }) {
  const [now_ms, setNow] = useState(() => Date.now());
  const clock = useInterval(() => setNow(Date.now()), REFRESH_MS);
  useEffect(() => {
    clock.start();
    return clock.stop;
  }, [clock.start, clock.stop]);
  const absolute = formatTime(time);
  const ago = formatAgo(time, now_ms);
  return (
    <time dateTime={time} title={absolute}>
      {isShort ? ago : `${absolute} (${ago})`}
    </time>
  );
}
