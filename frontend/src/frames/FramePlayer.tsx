import { ActionIcon, Group, NumberInput, Slider, Stack, Text } from "@mantine/core";
import {
  IconPlayerPause,
  IconPlayerPlay,
  IconPlayerSkipBack,
  IconPlayerSkipForward,
} from "@tabler/icons-react";
import { type KeyboardEvent, type ReactNode, useCallback, useEffect, useRef, useState } from "react";
import { formatCount } from "../platform/format";
import { ProblemAlert } from "../platform/ProblemAlert";
import { toProblem } from "../platform/problem";
import { type Scene, type Scenery, saveFile, sceneAsPng, sceneAsSvg } from "./drawing";
import { FilmDialog } from "./FilmDialog";
import { FrameCanvas } from "./FrameCanvas";
import { keyAction } from "./keys";
import type { Painter } from "./pen";
import type { FrameSource } from "./pictures";
import type { OnPick } from "./pointer";
import { PLAIN } from "./tone";
import { ViewTools } from "./ViewTools";
import { bounded, type View, wholeFrame, ZOOM_STEP } from "./viewport";

const FRAME_MS = 100;

type FramePlayerProps = {
  source: FrameSource;
  frame: number;
  onFrame: (frame: number) => void;
  paint?: Painter;
  /** What is drawn over any frame, and in its place: films need it. */
  sceneryOf?: (frame: number) => Promise<Scenery>;
  /** What is seen, for those who do not see it. */
  label: string;
  /** Time of a frame, as shown. */
  timeOf?: (frame: number) => string | undefined;
  /** The part that is seen, where somebody else keeps it. */
  view?: View;
  onView?: (view: View) => void;
  onPick?: OnPick;
  /** Stands left of the tools. */
  beside?: ReactNode;
  fileName?: string;
  /** One picture that does not go on, such as a mean. */
  isStill?: boolean;
  /** Shown in place of the frame as it came. */
  picture?: ImageBitmap;
};

/** A frame with its slider, step and play buttons, zoom, brightness and export; keys do the same. */
export function FramePlayer(props: FramePlayerProps) {
  const {
    source,
    frame,
    onFrame,
    paint,
    sceneryOf,
    label,
    timeOf,
    onPick,
    beside,
    fileName = "frame",
  } = props;
  const last = props.isStill ? 0 : source.n_frames - 1;
  const own = useState<View>(() => wholeFrame(source));
  const view = bounded(props.view ?? own[0], source);
  const onView = props.onView ?? own[1];
  const [tone, setTone] = useState(PLAIN);
  const [isFilming, setFilming] = useState(false);
  const [saving, setSaving] = useState<{ isBusy: boolean; error?: unknown }>({ isBusy: false });
  const go = useCallback((to: number) => onFrame(Math.min(last, Math.max(0, to))), [last, onFrame]);
  const { isPlaying, toggle, onShown } = usePlaying(frame, last, go);

  const zoom = (how: "closer" | "wider" | "whole") => {
    const factor = how === "closer" ? ZOOM_STEP : 1 / ZOOM_STEP;
    onView(how === "whole" ? wholeFrame(source) : bounded({ ...view, zoom: view.zoom * factor }, source));
  };
  const scene = (which: number, scenery: Scenery): Scene => {
    return { source, frame: which, view, tone, stamp: timeOf?.(which), ...scenery };
  };
  // A film without it would have what is drawn over this frame over all others.
  const isFilmable = last > 0 && (sceneryOf !== undefined || (!paint && !props.picture));
  const save = async (kind: "png" | "svg") => {
    setSaving({ isBusy: true });
    try {
      const blob = await (kind === "png" ? sceneAsPng : sceneAsSvg)(
        scene(frame, { paint, picture: props.picture }),
      );
      saveFile(blob, `${fileName}-${frame}.${kind}`);
      setSaving({ isBusy: false });
    } catch (error) {
      setSaving({ isBusy: false, error });
    }
  };
  const onKeyDown = (event: KeyboardEvent) => {
    const action = keyAction(event, frame, last);
    if (!action || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    if (action === "play") toggle();
    else if (typeof action === "string") zoom(action);
    else go(action.frame);
  };

  return (
    // biome-ignore lint/a11y/noStaticElementInteractions: keys that buttons and slider inside offer as well
    <div onKeyDown={onKeyDown}>
      <Stack gap="xs">
        <Group justify="space-between" gap="xs" align="flex-start">
          <div>{beside}</div>
          <ViewTools
            zoom={view.zoom}
            onZoom={zoom}
            tone={tone}
            onTone={setTone}
            onSave={save}
            onFilm={isFilmable ? () => setFilming(true) : undefined}
            isSaving={saving.isBusy}
          />
        </Group>
        {saving.error !== undefined && (
          <ProblemAlert problem={toProblem(saving.error)} title="Nothing was saved" />
        )}
        <FrameCanvas
          source={source}
          frame={frame}
          view={view}
          onView={onView}
          tone={tone}
          picture={props.picture}
          paint={paint}
          stamp={timeOf?.(frame)}
          label={label}
          onShown={onShown}
          onPick={onPick}
        />
        {last > 0 && (
          <Transport
            frame={frame}
            last={last}
            go={go}
            isPlaying={isPlaying}
            toggle={toggle}
            time={timeOf?.(frame)}
          />
        )}
      </Stack>
      {isFilming && (
        <FilmDialog
          isOpen
          onClose={() => setFilming(false)}
          frame={frame}
          last={last}
          sceneOf={async (which) => scene(which, sceneryOf ? await sceneryOf(which) : {})}
          fileName={fileName}
        />
      )}
    </div>
  );
}

/** Play waits for the frame that is on the canvas, and so never runs ahead of the network. */
function usePlaying(frame: number, last: number, go: (frame: number) => void) {
  const [isPlaying, setPlaying] = useState(false);
  const shown = useRef(-1);
  const onShown = useCallback((which: number) => {
    shown.current = which;
  }, []);
  const toggle = () => {
    if (!isPlaying && frame === last) go(0);
    setPlaying(!isPlaying);
  };
  useEffect(() => {
    if (!isPlaying) return;
    const clock = setInterval(() => {
      if (frame >= last) setPlaying(false);
      else if (shown.current === frame) go(frame + 1);
    }, FRAME_MS);
    return () => clearInterval(clock);
  }, [isPlaying, frame, last, go]);
  return { isPlaying, toggle, onShown };
}

type TransportProps = {
  frame: number;
  last: number;
  go: (frame: number) => void;
  isPlaying: boolean;
  toggle: () => void;
  time?: string;
};

function Transport({ frame, last, go, isPlaying, toggle, time }: TransportProps) {
  return (
    <Group gap="xs" wrap="nowrap" align="center">
      <Step
        label="Frame before"
        isDisabled={frame === 0}
        onClick={() => go(frame - 1)}
        icon={<IconPlayerSkipBack size={16} />}
      />
      <ActionIcon size="lg" aria-label={isPlaying ? "Pause" : "Play"} onClick={toggle}>
        {isPlaying ? <IconPlayerPause size={18} aria-hidden /> : <IconPlayerPlay size={18} aria-hidden />}
      </ActionIcon>
      <Step
        label="Next frame"
        isDisabled={frame === last}
        onClick={() => go(frame + 1)}
        icon={<IconPlayerSkipForward size={16} />}
      />
      <Slider
        flex={1}
        min={0}
        max={last}
        value={frame}
        onChange={go}
        label={null}
        thumbLabel="Frame"
        size="sm"
      />
      <NumberInput
        aria-label="Frame number"
        w={84}
        size="xs"
        min={0}
        max={last}
        value={frame}
        allowDecimal={false}
        hideControls
        onChange={(value) => typeof value === "number" && go(value)}
      />
      <Text fz="sm" c="dimmed" className="numbers" style={{ whiteSpace: "nowrap" }}>
        of 0 to {formatCount(last)}
        {time && `, ${time}`}
      </Text>
    </Group>
  );
}

function Step({
  label,
  isDisabled,
  onClick,
  icon,
}: {
  label: string;
  isDisabled: boolean;
  onClick: () => void;
  icon: ReactNode;
}) {
  return (
    <ActionIcon variant="default" size="lg" aria-label={label} disabled={isDisabled} onClick={onClick}>
      {icon}
    </ActionIcon>
  );
}
