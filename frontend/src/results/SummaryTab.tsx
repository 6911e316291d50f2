import { SimpleGrid } from "@mantine/core";
import type { Run } from "../client";
import { flatten } from "../forms/document";
import { type Fact, Facts } from "../platform/Facts";
import { plainField } from "../platform/fields";
import { formatTime } from "../platform/format";
import { Panel } from "../platform/Panel";
import { shown } from "../runs/differing";
import { NotYet } from "./NotYet";

/** Every number of `summary.json`, and what made it. */
export function SummaryTab({ run }: { run: Run }) {
  return (
    <SimpleGrid cols={{ base: 1, md: 2 }} spacing="md">
      <Panel title="Numbers">
        {run.summary ? <Facts facts={factsOf(run.summary)} label="Numbers" /> : <NotYet run={run} />}
      </Panel>
      <Panel title="Parameters" about="All of them, as this run used them.">
        <Facts facts={factsOf(run.parameters)} label="Parameters" />
      </Panel>
      <Panel title="Provenance">
        <Facts facts={provenanceOf(run)} label="Provenance" />
      </Panel>
    </SimpleGrid>
  );
}

function factsOf(document: Record<string, unknown>): Fact[] {
  return Object.entries(flatten(document)).map(([path, value]) => [plainField(path), shown(path, value)]);
}

function provenanceOf(run: Run): Fact[] {
  return [
    ["Run", run.id],
    ["Made with", `dropflow ${run.version}`],
    ["Started", run.started_at ? formatTime(run.started_at) : "–"],
    ["Finished", run.finished_at ? formatTime(run.finished_at) : "–"],
  ];
}
