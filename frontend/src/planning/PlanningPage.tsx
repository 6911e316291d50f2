import { Alert, Grid, Select, Stack, Text } from "@mantine/core";
import { useQuery } from "@tanstack/react-query";
import { getRouteApi } from "@tanstack/react-router";
import type { Material } from "../client";
import { Page } from "../platform/Page";
import { Panel } from "../platform/Panel";
import { Loading, QueryView } from "../platform/QueryView";
import type { Figure } from "../results/figure";
import { Plot } from "../results/Plot";
import { MaterialPanel } from "./MaterialPanel";
import { materialFigureQuery, materialsQuery } from "./queries";
import { RampPanel } from "./RampPanel";
import type { PlanSearch } from "./wish";

const route = getRouteApi("/planning");

/** Before the experiment: what the fluids do, how fast droplets will move, and the ramp that drives them. */
export function PlanningPage() {
  const materials = useQuery(materialsQuery);
  return (
    <Page title="Planning">
      <QueryView query={materials} loading={<Loading rows={6} height={48} />}>
        {(items) => <Plan materials={items} />}
      </QueryView>
    </Page>
  );
}

function Plan({ materials }: { materials: Material[] }) {
  const search = route.useSearch();
  const navigate = route.useNavigate();
  const change = (part: Partial<PlanSearch>) =>
    void navigate({ search: (old) => ({ ...old, ...part }), replace: true, resetScroll: false });
  const material =
    materials.find(({ name }) => name === search.material) ??
    materials.find(({ range_c }) => range_c !== null) ??
    materials[0];
  if (!material) return <Text>No material comes with this version.</Text>;
  return (
    <Stack gap="md">
      <Panel
        title="Material"
        about="Fluids whose properties come with the software; others can be added as a material file."
      >
        <Select
          aria-label="Material"
          maw={520}
          allowDeselect={false}
          value={material.name}
          onChange={(name) => change({ material: name ?? undefined, at_c: undefined })}
          data={materials.map(({ name, title }) => ({ value: name, label: title }))}
        />
        {material.is_illustrative && (
          <Alert color="orange" title="Illustrative numbers">
            They show the method and look like the paper’s, but were not measured. Replace them by measured
            ones before you rely on them.
          </Alert>
        )}
      </Panel>
      <MaterialPanel material={material} at_c={search.at_c} onTemperature={(at_c) => change({ at_c })} />
      {material.range_c && (
        <>
          <RampPanel material={material} search={search} onChange={change} />
          <Grid gap="md">
            <Grid.Col span={{ base: 12, md: 6 }}>
              <MaterialFigure
                material={material}
                figure="phase_diagram"
                title="Phase diagram"
                about="As Fig. 1 of the paper."
              />
            </Grid.Col>
            <Grid.Col span={{ base: 12, md: 6 }}>
              <MaterialFigure
                material={material}
                figure="viscosity"
                title="Viscosity"
                about="As Fig. 16 of the paper."
              />
            </Grid.Col>
          </Grid>
        </>
      )}
    </Stack>
  );
}

type MaterialFigureProps = {
  material: Material;
  figure: "phase_diagram" | "viscosity";
  title: string;
  about: string;
};

function MaterialFigure({ material, figure, title, about }: MaterialFigureProps) {
  const query = useQuery(materialFigureQuery(material.name, figure));
  return (
    <Panel title={title} about={about}>
      <QueryView query={query} loading={<Loading rows={1} height={380} />}>
        {(drawn) => (
          <Plot figure={drawn as unknown as Figure} label={`${title} of ${material.title}`} height={380} />
        )}
      </QueryView>
    </Panel>
  );
}
