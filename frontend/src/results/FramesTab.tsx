import { Box, Group, Loader, SegmentedControl, Stack, Switch, Text } from "@mantine/core";
import { useCallback, useMemo, useState } from "react";
import type { Experiment, FrameDroplets, Preview, Run } from "../client";
import { FramePlayer } from "../frames/FramePlayer";
import { frameSource, useStamp } from "../frames/source";
import { viewFromText, viewToText } from "../frames/viewport";
import { formatNumber, plural } from "../platform/format";
import { Panel } from "../platform/Panel";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { Reasons, whatIsAt } from "../previews/Rejected";
import type { ArrowField } from "./arrows";
import { colourSteps, scaleOf } from "./colours";
import { DropletPanel } from "./DropletPanel";
import { isFollowed, useFrameResults, useSceneryOf, useSecondLook } from "./frameResults";
import { LayerSwitches } from "./LayerSwitches";
import { NotYet } from "./NotYet";
import { dropletAt, type OverlayData, overlayPainter } from "./overlay";
import { type Colouring, LAYERS, type Layer, USUAL_LAYERS, useView } from "./view";

/** Frame by frame: the droplets, where they come from and go to, and the flow. */
export function FramesTab({ run, experiment }: { run: Run; experiment: Experiment }) {
  const { search, change } = useView();
  const { frame = 0, layers = USUAL_LAYERS, colour, view, droplet } = search;
  const isPrepared = search.prepared === true;
  const source = useMemo(() => {
    const frames = frameSource(experiment);
    return frames && isPrepared ? { ...frames, preparedIn: run.id } : frames;
  }, [experiment, isPrepared, run.id]);
  const stamp = useStamp(experiment);
  const shown = Math.min(frame, (source?.n_frames ?? 1) - 1);
  const n_frames = source?.n_frames ?? 1;
  const isTracked = isFollowed(run, n_frames);
  const found = useFrameResults(run, shown, n_frames, layers);
  const { droplets, field, error, isThere } = found;
  const colouring = useMemo(() => colouringOf(droplets, colour), [droplets, colour]);
  const dress = useCallback(
    (data: OverlayData) =>
      overlayPainter({ ...data, chosen: droplet, colouring }, (layer) => layers.includes(layer)),
    [droplet, colouring, layers],
  );
  const { tails } = found;
  const hasRejected = layers.includes("rejected");
  const look = useSecondLook(run, shown, hasRejected);
  const { rejected } = look;
  const [picked, setPicked] = useState<{ frame: number; what: string } | null>(null);
  const paint = useMemo(
    () => dress({ droplets, field, tails, rejected }),
    [dress, droplets, field, tails, rejected],
  );
  const sceneryOf = useSceneryOf(run, n_frames, layers, dress);
  if (!source) return <NotYet run={run} />;

  const toggle = (layer: Layer) => {
    const next = layers.includes(layer) ? layers.filter((one) => one !== layer) : [...layers, layer];
    change({ layers: LAYERS.filter((one) => next.includes(one)) });
  };
  const pick = (point: Parameters<typeof dropletAt>[1]) => {
    const index = droplets ? dropletAt(droplets, point) : null;
    const isRejected = index === null && rejected !== null && look.found !== null;
    setPicked(isRejected ? { frame: shown, what: whatIsAt(look.found as Preview, point, true) } : null);
    change({ droplet: index === null ? undefined : droplets?.trajectory_id?.[index] });
  };

  return (
    <Panel
      title="Droplets, frame by frame"
      about={describe(droplets, shown)}
      actions={field && <ArrowKey field={field} />}
    >
      {error && <ProblemAlert problem={toProblem(error)} />}
      <div className="viewer">
        <Box miw={0}>
          <FramePlayer
            source={source}
            frame={shown}
            onFrame={(to) => change({ frame: to })}
            paint={paint}
            sceneryOf={sceneryOf}
            label={`Frame ${shown} with droplets and flow. ${describe(droplets, shown)}`}
            timeOf={stamp}
            view={viewFromText(view)}
            onView={(next) => change({ view: viewToText(next) })}
            onPick={isTracked || hasRejected ? pick : undefined}
            fileName={`${String(experiment.experiment.name)}-run-${run.number}`}
            beside={
              <Group gap="sm">
                <ColourSwitch
                  colour={colour}
                  colouring={colouring}
                  onChange={(next) => change({ colour: next })}
                />
                <Switch
                  size="xs"
                  label="As detection sees it"
                  checked={isPrepared}
                  onChange={(event) => change({ prepared: event.currentTarget.checked || undefined })}
                />
                {look.isFetching && (
                  <Loader size="xs" role="img" aria-label="Looking at the frame once more" />
                )}
              </Group>
            }
          />
        </Box>
        <Stack gap="sm">
          <LayerSwitches
            shown={layers}
            offered={isTracked ? TRACKED_LAYERS : DETECTED_LAYERS}
            onToggle={toggle}
          />
          {look.error && (
            <ProblemAlert problem={toProblem(look.error)} title="No second look at this frame" />
          )}
          {rejected && <Reasons reasons={rejected.reason} />}
          {picked?.frame === shown && (
            <Text fz="sm" role="status">
              {picked.what}
            </Text>
          )}
          {droplet === undefined ? (
            <HowTo />
          ) : (
            <DropletPanel
              run={run}
              trajectoryId={droplet}
              frame={shown}
              onFrame={(to) => change({ frame: to })}
              onClose={() => change({ droplet: undefined })}
            />
          )}
        </Stack>
      </div>
      {isThere && !droplets && <NotYet run={run} />}
    </Panel>
  );
}

const TRACKED_LAYERS: Layer[] = [...LAYERS];
const DETECTED_LAYERS: Layer[] = ["now", "rejected"];

function HowTo() {
  return (
    <Text fz="sm" c="dimmed" component="div">
      <p style={{ marginTop: 0 }}>
        <b>Click a droplet</b> to see its size and velocity over time.
      </p>
      <p>
        <b>Double click</b>, or Ctrl and the wheel, zooms; drag to move.
      </p>
      <p style={{ marginBottom: 0 }}>
        <b>Keys:</b> arrows step one frame, with Shift ten; Home and End go to the first and last; the space
        bar plays; + − 0 zoom.
      </p>
    </Text>
  );
}

function colouringOf(droplets: FrameDroplets | null, by: Colouring | undefined): OverlayData["colouring"] {
  if (!by || !droplets) return undefined;
  return { by, scale: scaleOf(by === "match" ? droplets.match : droplets.r_px) };
}

type ColourSwitchProps = {
  colour: Colouring | undefined;
  colouring: OverlayData["colouring"];
  onChange: (colour: Colouring | undefined) => void;
};

/** One colour for all droplets, or one that says match or radius, with its scale. */
function ColourSwitch({ colour, colouring, onChange }: ColourSwitchProps) {
  return (
    <Group gap="sm" wrap="nowrap">
      <SegmentedControl
        size="xs"
        aria-label="Colour of the droplets"
        value={colour ?? "plain"}
        onChange={(value) => onChange(value === "plain" ? undefined : (value as Colouring))}
        data={[
          { value: "plain", label: "One colour" },
          { value: "match", label: "By match" },
          { value: "radius", label: "By radius" },
        ]}
      />
      {colouring && (
        <Group gap={6} wrap="nowrap">
          <Text fz="xs" className="numbers">
            {formatNumber(colouring.scale.low, 2)}
          </Text>
          <span
            aria-hidden
            className="colour-bar"
            style={{ backgroundImage: `linear-gradient(90deg, ${colourSteps().join()})` }}
          />
          <Text fz="xs" className="numbers" style={{ whiteSpace: "nowrap" }}>
            {formatNumber(colouring.scale.high, 2)}
            {colouring.by === "radius" && " px"}
          </Text>
        </Group>
      )}
    </Group>
  );
}

function describe(droplets: FrameDroplets | null, frame: number): string {
  if (!droplets) return "";
  const n = droplets.x_px.length;
  if (!droplets.is_detected) return `${plural(n, "droplet")} detected in frame ${frame}.`;
  const n_predicted = droplets.is_detected.filter((isDetected) => !isDetected).length;
  const n_going_on = droplets.next_x_px?.filter((x) => x != null).length ?? 0;
  const found = n_predicted > 0 ? `, ${n_predicted} of them found by prediction (dashed)` : "";
  return `${plural(n, "droplet")} on trajectories in frame ${frame}${found}; ${n_going_on} go on to the next frame.`;
}

/** How fast an arrow of what length is. */
export function ArrowKey({ field }: { field: ArrowField }) {
  return (
    <Group gap={6} wrap="nowrap">
      <svg width="44" height="12" aria-hidden="true">
        <path
          d="M2 6H40M33 2l7 4-7 4"
          fill="none"
          stroke="currentColor"
          strokeWidth="1.6"
          strokeLinecap="round"
        />
      </svg>
      <Text fz="sm" c="dimmed" className="numbers">
        {formatNumber(field.key_um_s)} µm/s: {formatNumber(field.key_px, 2)} px
      </Text>
    </Group>
  );
}
