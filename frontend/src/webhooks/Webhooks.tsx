import { Button, Checkbox, Group, Stack, Switch, Text, TextInput } from "@mantine/core";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import {
  type Asked,
  type Webhook,
  webhooksCreate,
  webhooksDelete,
  webhooksRenewSecret,
  webhooksUpdate,
} from "../client";
import { Once } from "../people/Once";
import { ConfirmButton } from "../platform/ConfirmButton";
import { Panel } from "../platform/Panel";
import { ProblemAlert } from "../platform/ProblemAlert";
import { fieldMessages, toProblem } from "../platform/problem";
import { QueryView } from "../platform/QueryView";
import { Notices } from "./Notices";
import { webhooksQuery } from "./queries";

const EVENTS: { value: Asked; label: string }[] = [
  { value: "run.completed", label: "a run completed" },
  { value: "run.failed", label: "a run failed" },
  { value: "run.cancelled", label: "a run was cancelled" },
];
const SECRET =
  "Copy it now: it cannot be shown again. What is sent is signed with it, as standardwebhooks.com says.";

/** Addresses elsewhere that are told what happens in a group. */
export function Webhooks({ groupId }: { groupId: string }) {
  const webhooks = useQuery(webhooksQuery(groupId));
  return (
    <Panel title="Webhooks" about="Addresses of programs that are told when runs of this group end.">
      <NewWebhookForm groupId={groupId} />
      <QueryView query={webhooks}>
        {({ items }) =>
          items.map((webhook) => <WebhookCard key={webhook.id} groupId={groupId} webhook={webhook} />)
        }
      </QueryView>
    </Panel>
  );
}

function NewWebhookForm({ groupId }: { groupId: string }) {
  const cache = useQueryClient();
  const [address, setAddress] = useState("");
  const [events, setEvents] = useState<string[]>(["run.completed", "run.failed"]);
  const make = useMutation({
    mutationFn: async () =>
      (await webhooksCreate({ path: { group_id: groupId }, body: { address, events: events as Asked[] } }))
        .data,
    onSuccess: async () => {
      setAddress("");
      await cache.invalidateQueries({ queryKey: webhooksQuery(groupId).queryKey });
    },
  });
  const problem = make.error && toProblem(make.error);
  const messages = fieldMessages(problem);
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        make.mutate();
      }}
    >
      <Stack gap="sm">
        <TextInput
          label="Address"
          placeholder="https://example.org/hook"
          type="url"
          required
          withAsterisk={false}
          maw={560}
          value={address}
          error={messages.address}
          onChange={(event) => setAddress(event.currentTarget.value)}
        />
        <Checkbox.Group label="Tell it that" value={events} onChange={setEvents} error={messages.events}>
          <Group gap="md" mt={4}>
            {EVENTS.map(({ value, label }) => (
              <Checkbox key={value} value={value} label={label} />
            ))}
          </Group>
        </Checkbox.Group>
        {problem && <ProblemAlert problem={problem} shownFields={(field) => field in messages} />}
        <div>
          <Button type="submit" loading={make.isPending} disabled={events.length === 0}>
            Add a webhook
          </Button>
        </div>
        {make.data && <Once label="Secret of the webhook" value={make.data.secret} about={SECRET} />}
      </Stack>
    </form>
  );
}

function WebhookCard({ groupId, webhook }: { groupId: string; webhook: Webhook }) {
  const cache = useQueryClient();
  const path = { group_id: groupId, webhook_id: webhook.id };
  const onSuccess = () => cache.invalidateQueries({ queryKey: webhooksQuery(groupId).queryKey });
  const change = useMutation({
    mutationFn: (is_active: boolean) => webhooksUpdate({ path, body: { is_active } }),
    onSuccess,
  });
  const remove = useMutation({ mutationFn: () => webhooksDelete({ path }), onSuccess });
  const renew = useMutation({ mutationFn: async () => (await webhooksRenewSecret({ path })).data });
  const told = EVENTS.filter(({ value }) => webhook.events.includes(value)).map(({ label }) => label);
  return (
    <Stack
      gap="xs"
      pt="sm"
      style={{ borderTop: "1px solid var(--dropflow-line)" }}
      role="group"
      aria-label={webhook.address}
    >
      <Group justify="space-between" wrap="nowrap" align="flex-start">
        <div style={{ minWidth: 0 }}>
          <Text fz="sm" ff="monospace" style={{ overflowWrap: "anywhere" }}>
            {webhook.address}
          </Text>
          <Text c="dimmed" fz="sm">
            Told that {told.join(", or that ")}
          </Text>
        </div>
        <Group gap="xs" wrap="nowrap">
          <Switch
            label="On"
            aria-label={`On: ${webhook.address}`}
            checked={webhook.is_active}
            disabled={change.isPending}
            onChange={(event) => change.mutate(event.currentTarget.checked)}
          />
          <ConfirmButton
            label="New secret"
            size="xs"
            title="Sign with a new secret?"
            action="Make a new one"
            mutation={renew}
          >
            The program that receives these notices refuses them until it knows the new secret.
          </ConfirmButton>
          <ConfirmButton
            label="Remove"
            size="xs"
            title="Remove this webhook?"
            action="Remove it"
            mutation={remove}
          >
            It is told nothing any more, and its log goes.
          </ConfirmButton>
        </Group>
      </Group>
      {renew.data && <Once label="New secret" value={renew.data.secret} about={SECRET} />}
      {change.error && <ProblemAlert problem={toProblem(change.error)} />}
      <Notices groupId={groupId} webhook={webhook} />
    </Stack>
  );
}
