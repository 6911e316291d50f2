import { Badge, Button, Group, NumberInput, Select, Stack, Table, Text, TextInput } from "@mantine/core";
import { queryOptions, useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import { type NewToken, type Token, tokensCreate, tokensList, tokensRevoke } from "../client";
import { ConfirmButton } from "../platform/ConfirmButton";
import { Moment } from "../platform/Moment";
import { Panel } from "../platform/Panel";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { QueryView } from "../platform/QueryView";
import { Once } from "./Once";

const SCOPES: { value: NonNullable<NewToken["scope"]>; label: string }[] = [
  { value: "read", label: "Read: look and download" },
  { value: "submit", label: "Submit: also upload, analyse and delete" },
  { value: "admin", label: "Admin: all that you can do" },
];

const tokensQuery = queryOptions({
  queryKey: ["tokens"],
  queryFn: async ({ signal }) => (await tokensList({ signal })).data,
});

/** Tokens let programs work for somebody. */
export function Tokens() {
  const tokens = useQuery(tokensQuery);
  return (
    <Panel
      title="Tokens"
      about="A program shows one to work for you, such as the script beside a microscope."
    >
      <NewTokenForm />
      <QueryView query={tokens}>
        {({ items }) =>
          items.length === 0 ? <Text fz="sm">You have no tokens.</Text> : <TokenTable tokens={items} />
        }
      </QueryView>
    </Panel>
  );
}

function NewTokenForm() {
  const cache = useQueryClient();
  const [token, setToken] = useState<Required<NewToken>>({ name: "", scope: "submit", days: 90 });
  const make = useMutation({
    mutationFn: async () => (await tokensCreate({ body: token })).data,
    onSuccess: async () => {
      setToken((before) => ({ ...before, name: "" }));
      await cache.invalidateQueries({ queryKey: tokensQuery.queryKey });
    },
  });
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        make.mutate();
      }}
    >
      <Stack gap="sm">
        <Group align="flex-end" gap="sm">
          <TextInput
            label="Name"
            placeholder="Microscope 2"
            required
            withAsterisk={false}
            value={token.name}
            onChange={(event) => {
              const { value } = event.currentTarget;
              setToken((before) => ({ ...before, name: value }));
            }}
          />
          <Select
            label="It may"
            data={SCOPES}
            value={token.scope}
            allowDeselect={false}
            w={350}
            maw="100%"
            onChange={(scope) =>
              scope && setToken((before) => ({ ...before, scope: scope as Token["scope"] }))
            }
          />
          <NumberInput
            label="Days"
            min={1}
            max={3660}
            w={90}
            allowDecimal={false}
            value={token.days}
            onChange={(days) => setToken((before) => ({ ...before, days: Number(days) || 1 }))}
          />
          <Button type="submit" loading={make.isPending}>
            Make a token
          </Button>
        </Group>
        {make.error && <ProblemAlert problem={toProblem(make.error)} />}
        {make.data && (
          <Once
            label={`Token ${make.data.name}`}
            value={make.data.secret}
            about="Copy it now: it is not kept here and cannot be shown again. Programs send it as `Authorization: Bearer …`."
          />
        )}
      </Stack>
    </form>
  );
}

function TokenTable({ tokens }: { tokens: Token[] }) {
  return (
    <Table.ScrollContainer minWidth={600}>
      <Table>
        <Table.Thead>
          <Table.Tr>
            <Table.Th>Name</Table.Th>
            <Table.Th>May</Table.Th>
            <Table.Th>Last used</Table.Th>
            <Table.Th>Expires</Table.Th>
            <Table.Th aria-label="Actions" />
          </Table.Tr>
        </Table.Thead>
        <Table.Tbody>
          {tokens.map((token) => (
            <Table.Tr key={token.id}>
              <Table.Td>
                {token.name}{" "}
                <Text span c="dimmed" fz="sm" ff="monospace">
                  {token.beginning}…
                </Text>
              </Table.Td>
              <Table.Td>
                <Badge variant="light">{token.scope}</Badge>
              </Table.Td>
              <Table.Td>{token.used_at ? <Moment time={token.used_at} isShort /> : "never"}</Table.Td>
              <Table.Td>
                <Moment time={token.expires_at} isShort />
              </Table.Td>
              <Table.Td>
                <Revoke token={token} />
              </Table.Td>
            </Table.Tr>
          ))}
        </Table.Tbody>
      </Table>
    </Table.ScrollContainer>
  );
}

function Revoke({ token }: { token: Token }) {
  const cache = useQueryClient();
  const revoke = useMutation({
    mutationFn: () => tokensRevoke({ path: { token_id: token.id } }),
    onSuccess: () => cache.invalidateQueries({ queryKey: tokensQuery.queryKey }),
  });
  return (
    <ConfirmButton
      label="Revoke"
      size="xs"
      title={`Revoke the token ${token.name}?`}
      action="Revoke it"
      mutation={revoke}
    >
      Programs that use it are refused from then on.
    </ConfirmButton>
  );
}
