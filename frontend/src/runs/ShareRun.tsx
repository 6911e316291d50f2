import { Button, Group, Modal, NumberInput, Stack, Table, Text } from "@mantine/core";
import { useDisclosure } from "@mantine/hooks";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { sharesCreate, sharesDelete, sharesList } from "../client";
import { Once } from "../people/Once";
import { sessionQuery } from "../people/session";
import { Moment } from "../platform/Moment";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";

/** Links by which anybody may look at this run; on one's own machine nobody else could follow them. */
export function ShareRun({ runId }: { runId: string }) {
  const { data: session } = useQuery(sessionQuery);
  const [isOpen, { open, close }] = useDisclosure(false);
  if (!session?.person || session.is_local) return null;
  return (
    <>
      <Button variant="default" onClick={open}>
        Share
      </Button>
      <Modal opened={isOpen} onClose={close} title="Share this run" centered>
        <Links runId={runId} />
      </Modal>
    </>
  );
}

function Links({ runId }: { runId: string }) {
  const cache = useQueryClient();
  const [days, setDays] = useState(30);
  const queryKey = ["runs", runId, "shares"];
  const shares = useQuery({
    queryKey,
    queryFn: async () => (await sharesList({ path: { run_id: runId } })).data,
  });
  const onSuccess = () => cache.invalidateQueries({ queryKey });
  const make = useMutation({
    mutationFn: async () => (await sharesCreate({ path: { run_id: runId }, body: { days } })).data,
    onSuccess,
  });
  const remove = useMutation({
    mutationFn: (share_id: string) => sharesDelete({ path: { run_id: runId, share_id } }),
    onSuccess,
  });
  const error = make.error ?? shares.error ?? remove.error;
  return (
    <Stack>
      <Text fz="sm">
        Whoever has the link can look at this one run and download its results, without an account.
      </Text>
      <Group align="flex-end">
        <NumberInput
          label="Days"
          min={1}
          max={365}
          w={90}
          allowDecimal={false}
          value={days}
          onChange={(value) => setDays(Number(value) || 1)}
        />
        <Button onClick={() => make.mutate()} loading={make.isPending}>
          Make a link
        </Button>
      </Group>
      {error && <ProblemAlert problem={toProblem(error)} />}
      {make.data && <Once label="Link" value={make.data.link} about="Copy it now: it is not shown again." />}
      {shares.data && shares.data.items.length > 0 && (
        <Table>
          <Table.Tbody>
            {shares.data.items.map((share) => (
              <Table.Tr key={share.id}>
                <Table.Td>
                  until <Moment time={share.expires_at} isShort />
                </Table.Td>
                <Table.Td>{share.used_at ? "opened" : "not opened yet"}</Table.Td>
                <Table.Td>
                  <Button size="xs" variant="default" onClick={() => remove.mutate(share.id)}>
                    Take back
                  </Button>
                </Table.Td>
              </Table.Tr>
            ))}
          </Table.Tbody>
        </Table>
      )}
    </Stack>
  );
}
