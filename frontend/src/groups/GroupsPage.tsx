import { Anchor, Badge, Button, Group, Table, TextInput } from "@mantine/core";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { Link, useNavigate } from "@tanstack/react-router";
import { useState } from "react";
import { groupsCreate } from "../client";
import { sessionQuery } from "../people/session";
import { Page } from "../platform/Page";
import { Panel } from "../platform/Panel";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { QueryView } from "../platform/QueryView";
import { groupsQuery } from "./queries";
import { UsageBar } from "./UsageBar";

/** The groups one is in. */
export function GroupsPage() {
  const groups = useQuery(groupsQuery);
  return (
    <Page title="Groups">
      <Panel
        title="Your groups"
        about="Experiments belong to a group: its members see them, and nobody else does."
      >
        <QueryView query={groups}>
          {({ items }) => (
            <Table>
              <Table.Thead>
                <Table.Tr>
                  <Table.Th>Group</Table.Th>
                  <Table.Th>You may</Table.Th>
                  <Table.Th>Members</Table.Th>
                  <Table.Th w="35%">Room</Table.Th>
                </Table.Tr>
              </Table.Thead>
              <Table.Tbody>
                {items.map((group) => (
                  <Table.Tr key={group.id}>
                    <Table.Td>
                      <Anchor
                        renderRoot={(props) => (
                          <Link to="/groups/$groupId" params={{ groupId: group.id }} {...props} />
                        )}
                      >
                        {group.name}
                      </Anchor>{" "}
                      {group.is_personal && <Badge variant="light">your own space</Badge>}
                    </Table.Td>
                    <Table.Td>{group.right ?? "administer"}</Table.Td>
                    <Table.Td>{group.n_members}</Table.Td>
                    <Table.Td>
                      <UsageBar usage={group.usage} />
                    </Table.Td>
                  </Table.Tr>
                ))}
              </Table.Tbody>
            </Table>
          )}
        </QueryView>
      </Panel>
      <NewGroupForm />
    </Page>
  );
}

function NewGroupForm() {
  const cache = useQueryClient();
  const navigate = useNavigate();
  const [name, setName] = useState("");
  const make = useMutation({
    mutationFn: async () => (await groupsCreate({ body: { name } })).data,
    onSuccess: async (group) => {
      await cache.invalidateQueries({ queryKey: groupsQuery.queryKey });
      await cache.invalidateQueries({ queryKey: sessionQuery.queryKey });
      await navigate({ to: "/groups/$groupId", params: { groupId: group.id } });
    },
  });
  return (
    <Panel title="New group" about="You manage it, and invite others to it.">
      <form
        onSubmit={(event) => {
          event.preventDefault();
          make.mutate();
        }}
      >
        <Group align="flex-end">
          <TextInput
            label="Name"
            required
            withAsterisk={false}
            value={name}
            onChange={(event) => setName(event.currentTarget.value)}
          />
          <Button type="submit" loading={make.isPending}>
            Make a group
          </Button>
        </Group>
      </form>
      {make.error && <ProblemAlert problem={toProblem(make.error)} />}
    </Panel>
  );
}
