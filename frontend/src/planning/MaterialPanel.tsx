import { Button, Grid, Slider, Stack, Table, Text, Title } from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { useQuery } from "@tanstack/react-query";
import { Link } from "@tanstack/react-router";
import { useEffect, useState } from "react";
import type { Material, MaterialProperties } from "../client";
import { formatNumber } from "../platform/format";
import { Panel } from "../platform/Panel";
import { QueryView } from "../platform/QueryView";
import { readableUnit } from "../platform/units";
import { materialQuery } from "./queries";

type MaterialPanelProps = {
  material: Material;
  at_c: number | undefined;
  onTemperature: (at_c: number | undefined) => void;
};

/** What is known of a material at a temperature, and how fast droplets move in it. */
export function MaterialPanel({ material, at_c, onTemperature }: MaterialPanelProps) {
  const query = useQuery(materialQuery(material.name, at_c));
  return (
    <Panel title="Properties" about="Each with where it comes from.">
      {material.range_c && (
        <Temperature
          key={material.name}
          range_c={material.range_c as [number, number]}
          at_c={at_c ?? query.data?.temperature_c ?? undefined}
          onTemperature={onTemperature}
        />
      )}
      <QueryView query={query}>
        {(found) => (
          <Grid gap="lg">
            <Grid.Col span={{ base: 12, md: 7 }}>
              <Properties found={found} />
            </Grid.Col>
            <Grid.Col span={{ base: 12, md: 5 }}>
              <Speeds found={found} />
            </Grid.Col>
          </Grid>
        )}
      </QueryView>
    </Panel>
  );
}

function Temperature({
  range_c: [low, high],
  at_c,
  onTemperature,
}: {
  range_c: [number, number];
  at_c: number | undefined;
  onTemperature: (at_c: number) => void;
}) {
  const [shown, setShown] = useState<number | null>(null);
  const [settled] = useDebouncedValue(shown, 150);
  // biome-ignore lint/correctness/useExhaustiveDependencies: only what was moved and came to rest is told
  useEffect(() => {
    if (settled !== null) onTemperature(settled);
  }, [settled]);
  const value = shown ?? at_c ?? (low + high) / 2;
  return (
    <div style={{ maxWidth: 520 }}>
      <Text fz="sm" fw={500} className="numbers">
        At {formatNumber(value, 4)} °C
      </Text>
      <Slider
        min={Math.ceil(low * 10) / 10}
        max={Math.floor(high * 10) / 10}
        step={0.1}
        label={null}
        value={value}
        onChange={setShown}
        thumbLabel="Temperature"
      />
    </div>
  );
}

/** Sources are long and many properties share them: each is told once, below. */
function Properties({ found }: { found: MaterialProperties }) {
  const sources = [...new Set(found.properties.flatMap(({ source }) => source.split("; ")))];
  const numbers = (source: string) => source.split("; ").map((one) => sources.indexOf(one) + 1);
  return (
    <Stack gap="xs">
      <Table fz="sm" verticalSpacing={4} aria-label="Properties">
        <Table.Thead>
          <Table.Tr>
            <Table.Th>Property</Table.Th>
            <Table.Th ta="right">Value</Table.Th>
            <Table.Th>Source</Table.Th>
          </Table.Tr>
        </Table.Thead>
        <Table.Tbody>
          {found.properties.map(({ name, value, unit, source }) => (
            <Table.Tr key={name}>
              <Table.Th scope="row" fw={400}>
                {readableName(name)}
              </Table.Th>
              <Table.Td ta="right" style={{ whiteSpace: "nowrap" }}>
                {formatNumber(value, 4)} {readableUnit(unit)}
              </Table.Td>
              <Table.Td c="dimmed" fz="xs">
                [{numbers(source).join(", ")}]
              </Table.Td>
            </Table.Tr>
          ))}
        </Table.Tbody>
      </Table>
      <Text component="ol" fz="xs" c="dimmed" m={0} pl="lg" aria-label="Sources">
        {sources.map((source) => (
          <li key={source}>{source}</li>
        ))}
      </Text>
    </Stack>
  );
}

function readableName(name: string): string {
  const words = name.replace(/_/g, " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}

/** Stokes' speeds, and the way to an experiment with these numbers. */
function Speeds({ found }: { found: MaterialProperties }) {
  return (
    <Stack gap="md">
      {found.sedimentation.map(({ phase, r_um, speed_um_s, delta_density_kg_m3, viscosity_pa_s }) => (
        <div key={phase ?? "only"}>
          <Title order={3}>Droplets {phase ? `in the ${phase} phase` : ""}</Title>
          <Text fz="xs" c="dimmed" mb={4}>
            Density difference {formatNumber(delta_density_kg_m3)} kg/m³, viscosity{" "}
            {formatNumber(viscosity_pa_s * 1e3)} mPa s
          </Text>
          <Table fz="sm" verticalSpacing={2} aria-label={`Speeds ${phase ?? ""}`}>
            <Table.Thead>
              <Table.Tr>
                <Table.Th>Radius</Table.Th>
                <Table.Th ta="right">{(speed_um_s[0] ?? 0) >= 0 ? "Rises with" : "Sinks with"}</Table.Th>
                <Table.Th ta="right">Moves its radius in</Table.Th>
              </Table.Tr>
            </Table.Thead>
            <Table.Tbody>
              {r_um.map((radius, index) => {
                const speed = Math.abs(speed_um_s[index] ?? 0);
                return (
                  <Table.Tr key={radius}>
                    <Table.Td>{formatNumber(radius)} µm</Table.Td>
                    <Table.Td ta="right">{formatNumber(speed)} µm/s</Table.Td>
                    <Table.Td ta="right">{formatNumber(radius / speed)} s</Table.Td>
                  </Table.Tr>
                );
              })}
            </Table.Tbody>
          </Table>
        </div>
      ))}
      {found.sedimentation.length > 0 && (
        <div>
          <Button
            variant="default"
            size="xs"
            renderRoot={(props) => <Link to="/experiments/new" {...props} />}
          >
            New experiment
          </Button>
        </div>
      )}
    </Stack>
  );
}
