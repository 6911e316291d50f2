import { Button, Table, Text } from "@mantine/core";
import { useMutation, useQuery, useQueryClient } from "@tanstack/react-query";
import { accountEndSession, accountSessions } from "../client";
import { Moment } from "../platform/Moment";
import { Panel } from "../platform/Panel";
import { QueryView } from "../platform/QueryView";

const KEY = ["account", "sessions"];

/** The browsers in which one is signed in, and a way out of each. */
export function Browsers() {
  const cache = useQueryClient();
  const browsers = useQuery({ queryKey: KEY, queryFn: async () => (await accountSessions()).data });
  const end = useMutation({
    mutationFn: (session_id: string) => accountEndSession({ path: { session_id } }),
    onSuccess: () => cache.invalidateQueries({ queryKey: KEY }),
  });
  return (
    <Panel title="Signed in" about="The browsers in which you are signed in.">
      <QueryView query={browsers}>
        {({ items }) =>
          items.length === 0 ? (
            <Text fz="sm">None: this service lets every browser of this machine in.</Text>
          ) : (
            <Table>
              <Table.Tbody>
                {items.map((browser) => (
                  <Table.Tr key={browser.id}>
                    <Table.Td style={{ overflowWrap: "anywhere" }}>
                      {browser.browser || "unknown browser"}
                    </Table.Td>
                    <Table.Td>
                      used <Moment time={browser.used_at} isShort />
                    </Table.Td>
                    <Table.Td>
                      {browser.is_this ? (
                        <Text fz="sm">this one</Text>
                      ) : (
                        <Button size="xs" variant="default" onClick={() => end.mutate(browser.id)}>
                          Sign out
                        </Button>
                      )}
                    </Table.Td>
                  </Table.Tr>
                ))}
              </Table.Tbody>
            </Table>
          )
        }
      </QueryView>
    </Panel>
  );
}
