import { Button, Group, Modal, Select, Stack, Text } from "@mantine/core";
import { useDisclosure } from "@mantine/hooks";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { type Experiment, experimentsMove } from "../client";
import { sessionQuery } from "../people/session";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";

/** Let an experiment belong to another group; nothing where there is no other. */
export function MoveExperiment({ experiment }: { experiment: Experiment }) {
  const cache = useQueryClient();
  const [isOpen, { open, close }] = useDisclosure(false);
  const [groupId, setGroupId] = useState<string | null>(null);
  const { data: session } = useQuery(sessionQuery);
  const editable = (session?.groups ?? []).filter(({ right }) => right === "edit" || right === "manage");
  const others = editable.filter(({ id }) => id !== experiment.group.id);
  const move = useMutation({
    mutationFn: (group_id: string) =>
      experimentsMove({ path: { experiment_id: experiment.id }, body: { group_id } }),
    onSuccess: async () => {
      await cache.invalidateQueries({ queryKey: ["experiments"] });
      close();
    },
  });
  if (others.length === 0 || editable.length === others.length) return null;
  return (
    <>
      <Button variant="default" onClick={open}>
        Move
      </Button>
      <Modal opened={isOpen} onClose={close} title="Move to another group" centered>
        <Stack>
          <Text fz="sm">
            Who is in {experiment.group.name} and not in the other group sees the experiment and its runs no
            more.
          </Text>
          <Select
            label="Group"
            data={others.map(({ id, name, is_personal }) => ({
              value: id,
              label: is_personal ? `${name} (your own space)` : name,
            }))}
            value={groupId}
            onChange={setGroupId}
          />
          {move.error && <ProblemAlert problem={toProblem(move.error)} />}
          <Group justify="flex-end" gap="xs">
            <Button variant="default" onClick={close}>
              Keep it
            </Button>
            <Button
              disabled={groupId === null}
              loading={move.isPending}
              onClick={() => groupId && move.mutate(groupId)}
            >
              Move it
            </Button>
          </Group>
        </Stack>
      </Modal>
    </>
  );
}
