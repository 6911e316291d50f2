import { Tabs } from "@mantine/core";
import { getRouteApi } from "@tanstack/react-router";
import { useEffect } from "react";
import type { Experiment, Run } from "../client";
import { later, whenIdle } from "../platform/later";
import { Loading } from "../platform/QueryView";
import { useFrameAhead } from "./ahead";
import { TABS, type Tab } from "./view";

const SizesTab = later(async () => (await import("./SizesTab")).SizesTab);
const TimeTab = later(async () => (await import("./TimeTab")).TimeTab);
const FramesTab = later(async () => (await import("./FramesTab")).FramesTab);
const FlowTab = later(async () => (await import("./FlowTab")).FlowTab);
const FiguresTab = later(async () => (await import("./FiguresTab")).FiguresTab);
const QualityTab = later(async () => (await import("./QualityTab")).QualityTab);
const SummaryTab = later(async () => (await import("./SummaryTab")).SummaryTab);
const FilesTab = later(async () => (await import("./FilesTab")).FilesTab);
const OTHERS = [TimeTab, FramesTab, FlowTab, FiguresTab, QualityTab, SummaryTab, FilesTab];

// What most look at first, and what draws it, come while the run itself is still being asked for.
void Promise.allSettled([SizesTab.preload(), import("./plotly")]);

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
  const { tab = "sizes", frame = 0 } = route.useSearch();
  const navigate = route.useNavigate();
  const choose = (next: string | null) =>
    navigate({ search: (old) => ({ ...old, tab: next as Tab }), resetScroll: false });
  // The others are a few kilobytes each: there before somebody asks for them. What fails is tried again then.
  useEffect(() => whenIdle(() => void Promise.allSettled(OTHERS.map(({ preload }) => preload()))), []);
  useFrameAhead(run, experiment, frame);
  return (
    <Tabs value={tab} onChange={choose} keepMounted={false}>
      <Tabs.List mb="md">
        {TABS.map((name) => (
          <Tabs.Tab key={name} value={name}>
            {TAB_TITLES[name]}
          </Tabs.Tab>
        ))}
      </Tabs.List>
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
    </Tabs>
  );
}
