import { Tabs } from "@mantine/core";
import { getRouteApi } from "@tanstack/react-router";
import { lazy, Suspense } from "react";
import type { Experiment, Run } from "../client";
import { Loading } from "../platform/QueryView";
import { TABS, type Tab } from "./view";

// What most look at first, and what draws it, come while the run itself is still being asked for.
const loadSizes = () => import("./SizesTab");
void Promise.allSettled([loadSizes(), import("./plotly")]);

const SizesTab = lazy(async () => ({ default: (await loadSizes()).SizesTab }));
const TimeTab = lazy(async () => ({ default: (await import("./TimeTab")).TimeTab }));
const FramesTab = lazy(async () => ({ default: (await import("./FramesTab")).FramesTab }));
const FlowTab = lazy(async () => ({ default: (await import("./FlowTab")).FlowTab }));
const FiguresTab = lazy(async () => ({ default: (await import("./FiguresTab")).FiguresTab }));
const QualityTab = lazy(async () => ({ default: (await import("./QualityTab")).QualityTab }));
const SummaryTab = lazy(async () => ({ default: (await import("./SummaryTab")).SummaryTab }));
const FilesTab = lazy(async () => ({ default: (await import("./FilesTab")).FilesTab }));

const route = getRouteApi("/runs/$runId");

const TAB_TITLES: Record<Tab, string> = {
  sizes: "Sizes",
  frames: "Droplets",
  flow: "Flow",
  figures: "Figures",
  quality: "Quality",
  time: "Over time",
  summary: "Numbers and parameters",
  files: "Downloads",
};

/** The results of a run, one tab a question; each comes with its first use. */
export function ResultTabs({ run, experiment }: { run: Run; experiment: Experiment | undefined }) {
  const { tab = "sizes" } = route.useSearch();
  const navigate = route.useNavigate();
  const choose = (next: string | null) =>
    navigate({ search: (old) => ({ ...old, tab: next as Tab }), resetScroll: false });
  return (
    <Tabs value={tab} onChange={choose} keepMounted={false}>
      <Tabs.List mb="md">
        {TABS.map((name) => (
          <Tabs.Tab key={name} value={name}>
            {TAB_TITLES[name]}
          </Tabs.Tab>
        ))}
      </Tabs.List>
      <Suspense fallback={<Loading rows={1} height={420} />}>
        <Tabs.Panel value="sizes">
          <SizesTab run={run} />
        </Tabs.Panel>
        <Tabs.Panel value="frames">
          {experiment ? <FramesTab run={run} experiment={experiment} /> : <Loading rows={1} height={420} />}
        </Tabs.Panel>
        <Tabs.Panel value="time">
          <TimeTab run={run} />
        </Tabs.Panel>
        <Tabs.Panel value="flow">
          {experiment ? <FlowTab run={run} experiment={experiment} /> : <Loading rows={1} height={420} />}
        </Tabs.Panel>
        <Tabs.Panel value="figures">
          {experiment ? <FiguresTab run={run} experiment={experiment} /> : <Loading rows={1} height={420} />}
        </Tabs.Panel>
        <Tabs.Panel value="quality">
          <QualityTab run={run} />
        </Tabs.Panel>
        <Tabs.Panel value="summary">
          <SummaryTab run={run} />
        </Tabs.Panel>
        <Tabs.Panel value="files">
          <FilesTab run={run} />
        </Tabs.Panel>
      </Suspense>
    </Tabs>
  );
}
