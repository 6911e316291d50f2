import { Alert, Button, List, SimpleGrid, Stack, Table, Text } from "@mantine/core";
import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { useMemo } from "react";
import type { Quality, Run } from "../client";
import { isMapping } from "../forms/document";
import { formatCount, formatNumber } from "../platform/format";
import { Panel } from "../platform/Panel";
import { Loading, QueryView } from "../platform/QueryView";
import type { Range, Ranges } from "./figure";
import { NotYet } from "./NotYet";
import { Plot } from "./Plot";
import { type QualityPlot, qualityFigure } from "./qualityFigure";
import { qualityQuery } from "./queries";
import { useSharedRanges } from "./view";

/** How well a run did: what was found, what was guessed, what was thrown away, and how sure it is. */
export function QualityTab({ run }: { run: Run }) {
  const { ranges, zoom, clear } = useSharedRanges();
  const query = useQuery({ ...qualityQuery(run, ranges), placeholderData: keepPreviousData });
  const { radius_um } = ranges;
  return (
    <Stack gap="md">
      <Warnings run={run} />
      <QueryView query={query} loading={<Loading rows={1} height={420} />}>
        {(quality) =>
          quality ? (
            <Panel
              title="Over time"
              about={
                radius_um && quality.is_of_radii
                  ? `Of droplets from ${formatNumber(radius_um[0])} to ${formatNumber(radius_um[1])} µm.`
                  : "Draw over a part of the time axis to look at it everywhere."
              }
              actions={
                (ranges.time_s || radius_um) && (
                  <Button size="compact-sm" variant="default" onClick={clear}>
                    Show everything
                  </Button>
                )
              }
            >
              {radius_um && !quality.is_of_radii && <OfAllRadii radius_um={radius_um} />}
              <SimpleGrid cols={{ base: 1, md: 2 }} spacing="md">
                {PLOTS.map((plot) => (
                  <QualityView
                    key={plot.title}
                    plot={plot}
                    quality={quality}
                    ranges={ranges}
                    onRanges={zoom}
                  />
                ))}
              </SimpleGrid>
            </Panel>
          ) : (
            <NotYet run={run} />
          )
        }
      </QueryView>
      <Rejected run={run} ranges={ranges} found={query.data?.trajectories ?? null} />
    </Stack>
  );
}

const PLOTS: QualityPlot[] = [
  {
    title: "Droplets a frame",
    about: "What detection found, and what is on trajectories after the consistency check.",
    axis: "droplets per frame",
    series: [
      { name: "detected", field: "n_detected", colour: "#0072B2" },
      { name: "on trajectories", field: "n_tracked", colour: "#D55E00" },
    ],
  },
  {
    title: "Found by prediction",
    about: "Share of the tracked droplets that detection missed and prediction found.",
    axis: "share (%)",
    factor: 100,
    series: [{ name: "by prediction", field: "predicted_share", colour: "#009E73" }],
  },
  {
    title: "Match and radius",
    about: "Mean match of detected droplets; mean relative uncertainty of the radius.",
    axis: "match",
    series: [{ name: "match", field: "match", colour: "#0072B2" }],
    right: {
      axis: "radius uncertainty (%)",
      factor: 100,
      name: "radius uncertainty",
      field: "radius_std_share",
      colour: "#D55E00",
    },
  },
  {
    title: "Prediction against finding",
    about: "Rms distance between where flow and sedimentation take a droplet and where it is found next.",
    axis: "residual (px)",
    series: [{ name: "residual", field: "residual_px", colour: "#009E73" }],
  },
];

type QualityViewProps = { plot: QualityPlot; quality: Quality } & Pick<
  Parameters<typeof Plot>[0],
  "ranges" | "onRanges"
>;

function QualityView({ plot, quality, ranges, onRanges }: QualityViewProps) {
  const figure = useMemo(() => qualityFigure(plot, quality), [plot, quality]);
  return (
    <div>
      <Text fw={500} fz="sm">
        {plot.title}
      </Text>
      <Text c="dimmed" fz="xs" mih={36}>
        {plot.about}
      </Text>
      <Plot figure={figure} label={plot.title} height={240} ranges={ranges} onRanges={onRanges} />
    </div>
  );
}

function Warnings({ run }: { run: Run }) {
  if (run.warnings.length === 0) return null;
  return (
    <Alert color="orange" title="Worth knowing">
      <List size="sm">
        {run.warnings.map((warning) => (
          <List.Item key={warning}>{warning}</List.Item>
        ))}
      </List>
    </Alert>
  );
}

const OF_RANGE = " Those whose middle in time and mean radius lie in what you look at.";

const REASONS: Record<string, string> = {
  brief:
    "In view in too few frames to make a trajectory; counts in the size distribution as far as it is probable.",
  short: "Seen in too few frames to be sure that it is a droplet.",
  stationary: "Did not move with the flow, as dirt on the chip does not.",
  doubtful: "Chance alone makes such a trajectory too easily.",
};

/** A run of an earlier version: what it counted, it counted over all radii. */
export function OfAllRadii({ radius_um: [low, high] }: { radius_um: Range }) {
  return (
    <Alert color="blue" role="status" mb="md" title="Of droplets of all radii">
      You look at {formatNumber(low)} to {formatNumber(high)} µm, but this run was made by a version that
      counted quality over all radii. A new run of the experiment counts it by radius; what is done is used
      again where it is the same.
    </Alert>
  );
}

type RejectedProps = { run: Run; ranges: Ranges; found: Record<string, number> | null };

function Rejected({ run, ranges, found }: RejectedProps) {
  const summary = run.summary?.n_rejected_trajectories;
  const isRangeSet = ranges.time_s !== undefined || ranges.radius_um !== undefined;
  if (!isMapping(summary)) return null;
  const { kept: foundKept, ...foundRejected } = found ?? {};
  const kept = foundKept ?? Number(run.summary?.n_trajectories ?? 0);
  const counts = found ? foundRejected : summary;
  const reasons = Object.entries(counts).map(([reason, n]) => [reason, Number(n)] as const);
  const total = kept + reasons.reduce((sum, [, n]) => sum + n, 0);
  return (
    <Panel
      title="Trajectories that were taken out"
      about={`The consistency check keeps what behaves like a droplet.${isRangeSet ? (found ? OF_RANGE : " Of the whole film and all radii.") : ""}`}
    >
      <Table fz="sm" aria-label="Trajectories that were taken out">
        <Table.Thead>
          <Table.Tr>
            <Table.Th>Trajectories</Table.Th>
            <Table.Th>Why</Table.Th>
            <Table.Th ta="right">How many</Table.Th>
            <Table.Th ta="right">Share</Table.Th>
          </Table.Tr>
        </Table.Thead>
        <Table.Tbody>
          {[["kept", kept] as const, ...reasons].map(([reason, n]) => (
            <Table.Tr key={reason}>
              <Table.Th scope="row" tt="capitalize">
                {reason}
              </Table.Th>
              <Table.Td>{reason === "kept" ? "Behaves like a droplet." : (REASONS[reason] ?? "")}</Table.Td>
              <Table.Td ta="right">{formatCount(n)}</Table.Td>
              <Table.Td ta="right">{formatNumber((100 * n) / Math.max(1, total), 2)} %</Table.Td>
            </Table.Tr>
          ))}
        </Table.Tbody>
      </Table>
    </Panel>
  );
}
