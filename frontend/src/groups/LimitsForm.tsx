import { Button, Group, NumberInput } from "@mantine/core";
import { useMutation, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { groupsLimit, type OwnGroup } from "../client";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { groupsQuery } from "./queries";

const GIGABYTE = 1e9;

/** What a group may use, for administrators; an empty field: what the service's settings say. */
export function LimitsForm({ group }: { group: OwnGroup }) {
  const cache = useQueryClient();
  const { usage } = group;
  const [room_gb, setRoom] = useState<number | "">(
    usage.max_bytes === null ? "" : usage.max_bytes / GIGABYTE,
  );
  const [runs, setRuns] = useState<number | "">(usage.max_active_runs ?? "");
  const change = useMutation({
    mutationFn: () =>
      groupsLimit({
        path: { group_id: group.id },
        body: {
          max_bytes: room_gb === "" ? null : Math.round(room_gb * GIGABYTE),
          max_active_runs: runs === "" ? null : runs,
        },
      }),
    onSuccess: () => cache.invalidateQueries({ queryKey: groupsQuery.queryKey }),
  });
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        change.mutate();
      }}
    >
      <Group align="flex-end" gap="sm">
        <NumberInput
          label="Room (GB)"
          placeholder="as set for all"
          min={0}
          w={160}
          value={room_gb}
          onChange={(value) => setRoom(value === "" ? "" : Number(value))}
        />
        <NumberInput
          label="Runs at once"
          placeholder="as set for all"
          min={1}
          allowDecimal={false}
          w={160}
          value={runs}
          onChange={(value) => setRuns(value === "" ? "" : Number(value))}
        />
        <Button type="submit" variant="default" loading={change.isPending}>
          Set limits
        </Button>
      </Group>
      {change.error && <ProblemAlert problem={toProblem(change.error)} />}
    </form>
  );
}
