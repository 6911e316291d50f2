import { Badge, Button, Group, Stack, Table, Text, TextInput } from "@mantine/core";
import { queryOptions, useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { useState } from "react";
import {
  type ChangePerson,
  type KnownPerson,
  peopleCreate,
  peopleLink,
  peopleList,
  peopleUpdate,
} from "../client";
import { Once } from "../people/Once";
import { Moment } from "../platform/Moment";
import { Panel } from "../platform/Panel";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { QueryView } from "../platform/QueryView";

const peopleQuery = queryOptions({
  queryKey: ["people"],
  queryFn: async ({ signal }) => (await peopleList({ signal })).data,
});

/** Everybody who has an account. */
export function People() {
  const people = useQuery(peopleQuery);
  return (
    <Panel title="People">
      <NewPersonForm />
      <QueryView query={people}>
        {({ items }) => (
          <Table>
            <Table.Tbody>
              {items.map((person) => (
                <PersonRow key={person.id} person={person} />
              ))}
            </Table.Tbody>
          </Table>
        )}
      </QueryView>
    </Panel>
  );
}

function NewPersonForm() {
  const cache = useQueryClient();
  const [name, setName] = useState("");
  const [email, setEmail] = useState("");
  const make = useMutation({
    mutationFn: async () => (await peopleCreate({ body: { name, email } })).data,
    onSuccess: () => cache.invalidateQueries({ queryKey: peopleQuery.queryKey }),
  });
  return (
    <form
      onSubmit={(event) => {
        event.preventDefault();
        make.mutate();
      }}
    >
      <Stack gap="sm">
        <Group align="flex-end">
          <TextInput
            label="Name"
            required
            withAsterisk={false}
            value={name}
            onChange={(event) => setName(event.currentTarget.value)}
          />
          <TextInput
            label="E-mail"
            type="email"
            required
            withAsterisk={false}
            value={email}
            onChange={(event) => setEmail(event.currentTarget.value)}
          />
          <Button type="submit" variant="default" loading={make.isPending}>
            Add
          </Button>
        </Group>
        {make.error && <ProblemAlert problem={toProblem(make.error)} />}
        {make.data && (
          <Once
            label={`Way in for ${make.data.person.name}`}
            value={make.data.link}
            about="Send it to them: it lets them in once, within two days, to choose a password."
          />
        )}
      </Stack>
    </form>
  );
}

function PersonRow({ person }: { person: KnownPerson }) {
  const cache = useQueryClient();
  const change = useMutation({
    mutationFn: (body: ChangePerson) => peopleUpdate({ path: { person_id: person.id }, body }),
    onSuccess: () => cache.invalidateQueries({ queryKey: peopleQuery.queryKey }),
  });
  const link = useMutation({
    mutationFn: async () => (await peopleLink({ path: { person_id: person.id } })).data,
  });
  return (
    <Table.Tr>
      <Table.Td>
        {person.name}{" "}
        <Text span c="dimmed" fz="sm">
          {person.email}
        </Text>{" "}
        {person.is_administrator && <Badge variant="light">administrator</Badge>}{" "}
        {person.is_disabled && (
          <Badge variant="light" color="gray">
            locked out
          </Badge>
        )}
        {link.data && (
          <Once
            label={`Way in for ${person.name}`}
            value={link.data.link}
            about="It lets them in once, within two days."
          />
        )}
        {change.error && (
          <Text c="red" fz="sm" role="alert">
            {toProblem(change.error).detail}
          </Text>
        )}
      </Table.Td>
      <Table.Td>{person.seen_at ? <Moment time={person.seen_at} isShort /> : "never here"}</Table.Td>
      <Table.Td>
        <Group gap="xs" justify="flex-end">
          <Button size="xs" variant="default" loading={link.isPending} onClick={() => link.mutate()}>
            Link to sign in
          </Button>
          <Button
            size="xs"
            variant="default"
            onClick={() => change.mutate({ is_administrator: !person.is_administrator })}
          >
            {person.is_administrator ? "No administrator" : "Make administrator"}
          </Button>
          <Button
            size="xs"
            variant="default"
            onClick={() => change.mutate({ is_disabled: !person.is_disabled })}
          >
            {person.is_disabled ? "Let in again" : "Lock out"}
          </Button>
        </Group>
      </Table.Td>
    </Table.Tr>
  );
}
