import { Button, Grid, Group, NumberInput, SegmentedControl, Stack, Switch, Text } from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { IconDownload } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import type { Material } from "../client";
import { apiUrl } from "../platform/base";
import { Facts } from "../platform/Facts";
import { formatDuration, formatNumber } from "../platform/format";
import { Panel } from "../platform/Panel";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { Loading } from "../platform/QueryView";
import type { Figure } from "../results/figure";
import { Plot } from "../results/Plot";
import { rampQuery } from "./queries";
import { PAPER, type PlanSearch, wishOf } from "./wish";

type RampPanelProps = {
  material: Material;
  search: PlanSearch;
  onChange: (part: Partial<PlanSearch>) => void;
};

/** The temperature ramp that keeps the driving parameter constant, to look at and to give to a controller. */
export function RampPanel({ material, search, onChange }: RampPanelProps) {
  const [settled] = useDebouncedValue(search, 250);
  const wish = wishOf(settled);
  const query = useQuery(rampQuery(material.name, wish));
  const ramp = query.error ? undefined : query.data;
  return (
    <Panel
      title="Temperature ramp"
      about="Keeps ξ = d ln Φ₀ / dt constant (eqs. 1 and 2): the phases part at a steady rate, faster in temperature as it gets hotter."
    >
      <Grid gap="lg">
        <Grid.Col span={{ base: 12, md: 4 }}>
          <Stack gap="sm">
            <Wishes search={search} onChange={onChange} />
            {query.error && <ProblemAlert problem={toProblem(query.error)} title="There is no such ramp" />}
            {ramp && (
              <Facts
                label="Ramp"
                facts={[
                  ["Driving ξ", `${formatNumber(ramp.driving_per_s, 4)} 1/s`],
                  ["Ramp takes", formatDuration(ramp.duration_s)],
                  ...(search.protocol
                    ? [["With mixing and rest", formatDuration(ramp.total_s)] as [string, string]]
                    : []),
                ]}
              />
            )}
            <Group>
              <Button
                component="a"
                href={apiUrl(["materials", material.name, "ramp.csv"], queryOf(wish))}
                download
                data-disabled={!ramp || undefined}
                leftSection={<IconDownload size={16} aria-hidden />}
              >
                Set points (CSV)
              </Button>
            </Group>
            <Text fz="xs" c="dimmed">
              One row a second: time_s, temperature_c, stage.
            </Text>
          </Stack>
        </Grid.Col>
        <Grid.Col span={{ base: 12, md: 8 }}>
          {ramp ? (
            <Plot figure={ramp.figure as unknown as Figure} label="Temperature ramp" height={360} />
          ) : (
            !query.error && <Loading rows={1} height={360} />
          )}
        </Grid.Col>
      </Grid>
    </Panel>
  );
}

function queryOf(wish: ReturnType<typeof wishOf>): Record<string, string | number | undefined> {
  return { ...wish, has_protocol: wish.has_protocol ? "true" : undefined };
}

function Wishes({ search, onChange }: { search: PlanSearch; onChange: (part: Partial<PlanSearch>) => void }) {
  const isByDuration = search.hours !== undefined;
  return (
    <>
      <Group grow>
        <Value
          label="From"
          unit="°C"
          value={search.start_c ?? PAPER.start_c}
          onChange={(start_c) => onChange({ start_c })}
        />
        <Value
          label="To"
          unit="°C"
          value={search.end_c ?? PAPER.end_c}
          onChange={(end_c) => onChange({ end_c })}
        />
      </Group>
      <SegmentedControl
        size="xs"
        aria-label="What is given"
        value={isByDuration ? "hours" : "xi"}
        onChange={(value) => onChange(value === "hours" ? { hours: 8, xi: undefined } : { hours: undefined })}
        data={[
          { value: "xi", label: "Driving ξ is given" },
          { value: "hours", label: "Duration is given" },
        ]}
      />
      {isByDuration ? (
        <Value
          label="Duration"
          unit="h"
          value={search.hours ?? 8}
          onChange={(hours) => onChange({ hours })}
        />
      ) : (
        <Value
          label="Driving parameter ξ, in 10⁻⁶"
          unit="1/s"
          value={Number(((search.xi ?? PAPER.xi) * 1e6).toPrecision(6))}
          onChange={(value) => onChange({ xi: value * 1e-6 })}
        />
      )}
      <Switch
        label="Begin with an hour of mixing and four of equilibration"
        checked={search.protocol === true}
        onChange={(event) => onChange({ protocol: event.currentTarget.checked || undefined })}
      />
    </>
  );
}

type ValueProps = { label: string; unit: string; value: number; onChange: (value: number) => void };

function Value({ label, unit, value, onChange }: ValueProps) {
  return (
    <NumberInput
      label={`${label} (${unit})`}
      value={value}
      hideControls
      decimalScale={6}
      onChange={(next) => typeof next === "number" && onChange(next)}
    />
  );
}
