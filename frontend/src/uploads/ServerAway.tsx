import { Alert, Button, Group, Text } from "@mantine/core";
import { useEffect, useState } from "react";
import { plural } from "../platform/format";
import type { Away } from "./patience";

type ServerAwayProps = { away: Away; onTryNow: () => void };

/** That nobody answers, when it is tried again, and a way to try at once. */
export function ServerAway({ away, onTryNow }: ServerAwayProps) {
  const left_s = useSecondsUntil(away.until_ms);
  return (
    <Alert color="orange" p="xs">
      <Group justify="space-between" gap="xs">
        <Text fz="sm">
          <span role="status">{away.problem.detail} What arrived stays.</span>{" "}
          <span className="numbers">
            {left_s > 0 ? `Trying again in ${plural(left_s, "second")}.` : "Trying again."}
          </span>
        </Text>
        <Button size="compact-sm" variant="default" onClick={onTryNow} disabled={left_s === 0}>
          Try now
        </Button>
      </Group>
    </Alert>
  );
}

function useSecondsUntil(until_ms: number): number {
  const [now_ms, setNow] = useState(Date.now);
  useEffect(() => {
    const timer = setInterval(() => setNow(Date.now()), 500);
    return () => clearInterval(timer);
  }, []);
  return Math.max(0, Math.ceil((until_ms - now_ms) / 1000));
}
