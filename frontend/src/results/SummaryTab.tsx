import { Grid, Stack } from "@mantine/core";
import type { Run } from "../client";
import { Panel } from "../platform/Panel";
import { NotYet } from "./NotYet";
import { ParameterTable } from "./ParameterTable";
import { Provenance } from "./Provenance";
import { SummaryNumbers } from "./SummaryNumbers";

/** Every number of a run, and what made it. */
export function SummaryTab({ run }: { run: Run }) {
  return (
    <Grid gap="md">
      <Grid.Col span={{ base: 12, md: 6 }}>
        <Stack gap="md">
          <Panel title="Numbers" about="As in summary.json.">
            {run.summary ? <SummaryNumbers summary={run.summary} /> : <NotYet run={run} />}
          </Panel>
          <Provenance run={run} />
        </Stack>
      </Grid.Col>
      <Grid.Col span={{ base: 12, md: 6 }}>
        <Panel title="Parameters" about="All of them, as this run used them.">
          <ParameterTable parameters={run.parameters} />
        </Panel>
      </Grid.Col>
    </Grid>
  );
}
