import { Code } from "@mantine/core";
import type { Run } from "../client";
import { isMapping } from "../forms/document";
import { type Fact, Facts } from "../platform/Facts";
import { formatDuration } from "../platform/format";
import { Moment } from "../platform/Moment";
import { Panel } from "../platform/Panel";

/** What made these results: enough to make them again. */
export function Provenance({ run }: { run: Run }) {
  const provenance = isMapping(run.summary?.provenance) ? run.summary.provenance : {};
  const facts: Fact[] = [
    ["Software", `dropflow ${run.version}`],
    [
      "Frames, SHA-256",
      provenance.input_sha256 ? <Code key="sha">{String(provenance.input_sha256)}</Code> : "–",
    ],
    ["Run", <Code key="run">{run.id}</Code>],
    ["Started", run.started_at ? <Moment key="started" time={run.started_at} /> : "–"],
    ["Took", tookOf(run)],
    ["Units", String(provenance.units ?? "as the names say")],
  ];
  return (
    <Panel
      title="Provenance"
      about="Every file of the results carries this, the parameters and the description too."
    >
      <Facts facts={facts} label="Provenance" />
    </Panel>
  );
}

function tookOf({ started_at, finished_at }: Run): string {
  if (!started_at || !finished_at) return "–";
  return formatDuration((Date.parse(finished_at) - Date.parse(started_at)) / 1000);
}
