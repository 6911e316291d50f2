import { Badge, Button, Group, Stack, Table, Text } from "@mantine/core";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { type Notice, noticesResend, type Try, type Webhook, webhooksTest } from "../client";
import { Moment } from "../platform/Moment";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { QueryView } from "../platform/QueryView";
import { noticesQuery } from "./queries";

const COLOUR = { delivered: "teal", waiting: "gray", failed: "red" } as const;

/** The log of one webhook: what it was told, each try, and how it answered. */
export function Notices({ groupId, webhook }: { groupId: string; webhook: Webhook }) {
  const cache = useQueryClient();
  const query = noticesQuery(groupId, webhook.id);
  const notices = useQuery(query);
  const onSuccess = () => cache.invalidateQueries({ queryKey: query.queryKey });
  const path = { group_id: groupId, webhook_id: webhook.id };
  const test = useMutation({ mutationFn: () => webhooksTest({ path }), onSuccess });
  const resend = useMutation({
    mutationFn: (notice_id: string) => noticesResend({ path: { ...path, notice_id } }),
    onSuccess,
  });
  const problem = test.error ?? resend.error;
  return (
    <Stack gap="xs">
      <QueryView query={notices}>
        {({ items }) =>
          items.length === 0 ? (
            <Text fz="sm">It was told nothing yet.</Text>
          ) : (
            <Table.ScrollContainer minWidth={560}>
              <Table aria-label={`Told to ${webhook.address}`}>
                <Table.Thead>
                  <Table.Tr>
                    <Table.Th>Event</Table.Th>
                    <Table.Th>When</Table.Th>
                    <Table.Th>State</Table.Th>
                    <Table.Th>Last answer</Table.Th>
                    <Table.Th aria-label="Actions" />
                  </Table.Tr>
                </Table.Thead>
                <Table.Tbody>
                  {items.map((notice) => (
                    <NoticeRow
                      key={notice.id}
                      notice={notice}
                      resend={webhook.is_active ? () => resend.mutate(notice.id) : null}
                    />
                  ))}
                </Table.Tbody>
              </Table>
            </Table.ScrollContainer>
          )
        }
      </QueryView>
      {problem && <ProblemAlert problem={toProblem(problem)} />}
      <Group>
        <Button
          size="xs"
          variant="default"
          disabled={!webhook.is_active}
          loading={test.isPending}
          onClick={() => test.mutate()}
        >
          Send a test
        </Button>
      </Group>
    </Stack>
  );
}

type NoticeRowProps = { notice: Notice; resend: (() => void) | null };

function NoticeRow({ notice, resend }: NoticeRowProps) {
  const last = notice.tries.at(-1);
  return (
    <Table.Tr>
      <Table.Td>
        {notice.event}
        {notice.resend_of && " (again)"}
      </Table.Td>
      <Table.Td>
        <Moment time={notice.created_at} isShort />
      </Table.Td>
      <Table.Td>
        <Badge variant="light" color={COLOUR[notice.state]}>
          {notice.state}
        </Badge>
      </Table.Td>
      <Table.Td>
        {last ? answered(last) : "not sent yet"}
        {notice.tries.length > 1 && `, at try ${notice.tries.length}`}
        {last && notice.next_try_at && (
          <Text c="dimmed" fz="sm">
            Tried again <Moment time={notice.next_try_at} isShort />
          </Text>
        )}
      </Table.Td>
      <Table.Td>
        {notice.state !== "waiting" && resend && (
          <Button size="xs" variant="default" onClick={resend}>
            Send again
          </Button>
        )}
      </Table.Td>
    </Table.Tr>
  );
}

function answered(last: Try): string {
  return [last.status, last.problem].filter((part) => part !== null).join(": ");
}
