import { Anchor, Code, Group, Table, Text } from "@mantine/core";
import { IconDownload } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import type { Run } from "../client";
import { apiUrl } from "../platform/base";
import { formatBytes } from "../platform/format";
import { Panel } from "../platform/Panel";
import { QueryView } from "../platform/QueryView";
import { NotYet } from "./NotYet";
import { resultFilesQuery } from "./queries";

const ABOUT: Record<string, string> = {
  "droplets.parquet": "Every detected droplet: position, radius, match. One row a droplet.",
  "trajectories.parquet": "Droplets on trajectories with their velocities, after tracking.",
  "rejected_trajectories.parquet": "Trajectories that filtering took out, with the reason.",
  "events.parquet": "Where trajectories begin and end, and why; which two droplets became one.",
  "flow.zarr.zip": "The flow field of every frame, as a Zarr store (unzip it, or read it as it is).",
  "summary.json": "The numbers of this run with its parameters.",
};

/** Results to download. */
export function FilesTab({ run }: { run: Run }) {
  const query = useQuery(resultFilesQuery(run));
  return (
    <Panel title="Downloads" about="Column names carry their units; image axes: x right, y down.">
      <QueryView query={query}>
        {(files) =>
          files.length === 0 ? (
            <NotYet run={run} />
          ) : (
            <Table.ScrollContainer
              minWidth={520}
              type="native"
              tabIndex={0}
              role="region"
              aria-label="Table of files"
            >
              <Table verticalSpacing="sm">
                <Table.Thead>
                  <Table.Tr>
                    <Table.Th>File</Table.Th>
                    <Table.Th>What it holds</Table.Th>
                    <Table.Th ta="right">Size</Table.Th>
                  </Table.Tr>
                </Table.Thead>
                <Table.Tbody>
                  {files.map(({ name, size_bytes }) => (
                    <Table.Tr key={name}>
                      <Table.Td>
                        <Anchor href={apiUrl(["runs", run.id, "files", name])} download={name}>
                          <Group gap={6} wrap="nowrap">
                            <IconDownload size={16} aria-hidden />
                            <Code>{name}</Code>
                          </Group>
                        </Anchor>
                      </Table.Td>
                      <Table.Td>
                        <Text fz="sm">{ABOUT[name] ?? ""}</Text>
                      </Table.Td>
                      <Table.Td ta="right">{size_bytes == null ? "" : formatBytes(size_bytes)}</Table.Td>
                    </Table.Tr>
                  ))}
                </Table.Tbody>
              </Table>
            </Table.ScrollContainer>
          )
        }
      </QueryView>
    </Panel>
  );
}
