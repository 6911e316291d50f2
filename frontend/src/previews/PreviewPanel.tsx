import { Alert, Group, Loader, SegmentedControl, Stack, Switch, Text } from "@mantine/core";
import { useDebouncedValue } from "@mantine/hooks";
import { keepPreviousData, useQuery } from "@tanstack/react-query";
import { useMemo, useState } from "react";
import type { Experiment, FrameDroplets, LinkPreview, Preview } from "../client";
import type { Document } from "../forms/document";
import { FramePlayer } from "../frames/FramePlayer";
import { frameSource, useStamp } from "../frames/source";
import { type View, wholeFrame } from "../frames/viewport";
import { formatCount, formatNumber, plural } from "../platform/format";
import { Panel } from "../platform/Panel";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { overlayPainter } from "../results/overlay";
import { linkPreviewQuery, previewQuery } from "./queries";
import { Reasons, whatIsAt } from "./Rejected";
import { firstRegion, patched } from "./region";
import { usePicture } from "./usePicture";

const PAUSE_MS = 200;

type PreviewPanelProps = { experiment: Experiment; parameters: Document; isValid: boolean };

/** What a run with these parameters would find in a frame, seen while a knob is moved. */
export function PreviewPanel({ experiment, parameters, isValid }: PreviewPanelProps) {
  const source = useMemo(() => frameSource(experiment), [experiment]);
  const [what, setWhat] = useState<"droplets" | "links">("droplets");
  const [frame, setFrame] = useState(0);
  const [settled] = useDebouncedValue(parameters, PAUSE_MS);
  if (!source) return null;
  const look = { experiment, source, frame, setFrame, parameters: settled, isValid };
  return (
    <Panel
      title="Preview"
      about="Move a knob and see what a run would find. Nothing is kept."
      actions={
        source.n_frames > 1 && (
          <SegmentedControl
            size="xs"
            aria-label="What is previewed"
            value={what}
            onChange={(value) => setWhat(value as typeof what)}
            data={[
              { value: "droplets", label: "Droplets" },
              { value: "links", label: "Following" },
            ]}
          />
        )
      }
    >
      {what === "droplets" ? <DropletLook {...look} /> : <LinkLook {...look} />}
    </Panel>
  );
}

type LookProps = {
  experiment: Experiment;
  source: NonNullable<ReturnType<typeof frameSource>>;
  frame: number;
  setFrame: (frame: number) => void;
  parameters: Document;
  isValid: boolean;
};

function DropletLook({ experiment, source, frame, setFrame, parameters, isValid }: LookProps) {
  const stamp = useStamp(experiment);
  const [view, setView] = useState<View>(() => wholeFrame(source));
  const [seen] = useDebouncedValue(view, PAUSE_MS);
  const [hasRejected, setRejected] = useState(false);
  const [isPrepared, setPrepared] = useState(false);
  const [picked, setPicked] = useState<string | null>(null);
  const region = useMemo(() => firstRegion(source, seen), [source, seen]);
  const only = useMemo(() => ({ detection: parameters.detection }), [parameters.detection]);
  const first = useQuery({
    ...previewQuery(experiment.id, frame, only, region),
    enabled: isValid && region !== null,
  });
  const whole = useQuery({
    ...previewQuery(experiment.id, frame, only, null, isPrepared),
    enabled: isValid && (region === null || first.isSuccess || first.isError),
    placeholderData: keepPreviousData,
  });
  const isWhole = whole.isSuccess && !whole.isPlaceholderData;
  const shown = isWhole || !first.data ? whole.data : patched(first.data, whole.data);
  const picture = usePicture(isPrepared && isWhole ? whole.data.prepared_jpeg : null);
  const paint = useMemo(
    () =>
      overlayPainter(
        { droplets: shown ? asDroplets(shown, frame) : null, field: null, rejected: shown?.rejected },
        (layer) => layer === "now" || (layer === "rejected" && hasRejected),
      ),
    [shown, frame, hasRejected],
  );
  const error = whole.error ?? first.error;

  return (
    <Stack gap="xs">
      {error && <ProblemAlert problem={toProblem(error)} title="No preview" />}
      <FramePlayer
        source={source}
        frame={frame}
        onFrame={(to) => {
          setPicked(null);
          setFrame(to);
        }}
        paint={paint}
        picture={picture ?? undefined}
        label={`Preview of frame ${frame}: ${shown ? plural(shown.x_px.length, "droplet") : "not looked at yet"}`}
        timeOf={stamp}
        view={view}
        onView={setView}
        onPick={(point) => setPicked(shown ? whatIsAt(shown, point, hasRejected) : null)}
        fileName={`${String(experiment.experiment.name)}-preview`}
        beside={
          <Group gap="md">
            <Switch
              size="xs"
              label="Rejected candidates"
              checked={hasRejected}
              onChange={(event) => setRejected(event.currentTarget.checked)}
            />
            <Switch
              size="xs"
              label="As detection sees it"
              checked={isPrepared}
              onChange={(event) => setPrepared(event.currentTarget.checked)}
            />
          </Group>
        }
      />
      <Group gap="sm" mih={24} role="status">
        {(first.isFetching || whole.isFetching) && <Loader size="xs" role="img" aria-label="Looking" />}
        {shown && (
          <Text fz="sm" className="numbers">
            <b>{plural(shown.x_px.length, "droplet")}</b>
            {isWhole
              ? `, ${plural(shown.rejected.x_px.length, "candidate")} rejected, looked at in ${formatNumber(whole.data.took_s, 2)} s`
              : "; the rest of the frame follows"}
          </Text>
        )}
        {picked && (
          <Text fz="sm" c="dimmed">
            {picked}
          </Text>
        )}
      </Group>
      {hasRejected && shown && <Reasons reasons={shown.rejected.reason} />}
    </Stack>
  );
}

function asDroplets(found: Pick<Preview, "x_px" | "y_px" | "r_px" | "match">, frame: number): FrameDroplets {
  const { x_px, y_px, r_px } = found;
  return { frame, x_px, y_px, r_px, match: found.match.map((match) => match ?? 0) } as FrameDroplets;
}

function LinkLook({ experiment, source, frame, setFrame, parameters, isValid }: LookProps) {
  const stamp = useStamp(experiment);
  const last = source.n_frames - 2;
  const here = Math.min(frame, last);
  const query = useQuery({
    ...linkPreviewQuery(experiment.id, here, parameters),
    enabled: isValid,
    placeholderData: keepPreviousData,
  });
  const links = query.data?.frame === here ? query.data : undefined;
  const paint = useMemo(
    () =>
      overlayPainter({ droplets: links ? asLinked(links) : null, field: null, predictions: links }, (layer) =>
        ["now", "predicted", "next", "steps"].includes(layer),
      ),
    [links],
  );
  return (
    <Stack gap="xs">
      {query.error && <ProblemAlert problem={toProblem(query.error)} title="No preview" />}
      <FramePlayer
        source={{ ...source, n_frames: last + 1 }}
        frame={here}
        onFrame={setFrame}
        paint={paint}
        label={`Following from frame ${here} to the next. ${links ? describeLinks(links) : ""}`}
        timeOf={stamp}
        fileName={`${String(experiment.experiment.name)}-following`}
        beside={
          <Text fz="xs" c="dimmed">
            Red: this frame. Green: found in the next. White: the way. Yellow cross: where it was predicted.
          </Text>
        }
      />
      <Group gap="sm" mih={24} role="status">
        {query.isFetching && <Loader size="xs" role="img" aria-label="Following" />}
        {links && <Text fz="sm">{describeLinks(links)}</Text>}
      </Group>
      {links && links.n_frames < 4 && (
        <Alert color="orange">Only {links.n_frames} frames are left here to learn the flow from.</Alert>
      )}
    </Stack>
  );
}

function asLinked(links: LinkPreview): FrameDroplets {
  return { ...links, match: links.x_px.map(() => 0) } as unknown as FrameDroplets;
}

export function describeLinks(links: LinkPreview): string {
  const found = links.next_x_px.flatMap((x, index) => {
    const [y, px, py] = [links.next_y_px[index], links.predicted_x_px[index], links.predicted_y_px[index]];
    return x == null || y == null || px == null || py == null ? [] : [Math.hypot(x - px, y - py)];
  });
  const n_found = links.next_x_px.filter((x) => x !== null).length;
  const middle = [...found].sort((a, b) => a - b)[Math.floor(found.length / 2)];
  const off =
    middle === undefined ? "" : `, typically ${formatNumber(middle, 2)} px from where they were predicted`;
  return `${formatCount(n_found)} of ${plural(links.x_px.length, "droplet")} on trajectories found again in the next frame${off}; ${plural(links.n_frames, "frame")} followed in ${formatNumber(links.took_s, 2)} s.`;
}
