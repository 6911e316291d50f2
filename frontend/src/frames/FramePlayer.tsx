import { ActionIcon, Group, NumberInput, Slider, Stack, Text } from "@mantine/core";
import {
  IconPlayerPause,
  IconPlayerPlay,
  IconPlayerSkipBack,
  IconPlayerSkipForward,
} from "@tabler/icons-react";
import { type KeyboardEvent, type ReactNode, useCallback, useEffect, useRef, useState } from "react";
import { formatCount } from "../platform/format";
import { FrameCanvas, type Painter } from "./FrameCanvas";
import { keyAction } from "./keys";
import type { FrameSource } from "./pictures";

const FRAME_MS = 120;

type FramePlayerProps = {
  source: FrameSource;
  frame: number;
  onFrame: (frame: number) => void;
  paint?: Painter;
  /** What is seen, for those who do not see it. */
  label: string;
  /** Time of the frame, as shown. */
  time?: string;
};

/** A frame with its slider, step and play buttons; arrows, Home, End and the space bar do the same. */
export function FramePlayer({ source, frame, onFrame, paint, label, time }: FramePlayerProps) {
  const last = source.n_frames - 1;
  const [isPlaying, setPlaying] = useState(false);
  // Play waits for the frame that is on the canvas, and so never runs ahead of the network.
  const shown = useRef(-1);
  const onShown = useCallback((which: number) => {
    shown.current = which;
  }, []);
  const go = useCallback((to: number) => onFrame(Math.min(last, Math.max(0, to))), [last, onFrame]);
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

  const onKeyDown = (event: KeyboardEvent) => {
    const action = keyAction(event, frame, last);
    if (!action) return;
    event.preventDefault();
    if (action === "play") toggle();
    else go(action.frame);
  };

  return (
    // biome-ignore lint/a11y/noStaticElementInteractions: keys that buttons and slider inside offer as well
    <div onKeyDown={onKeyDown}>
      <Stack gap="xs">
        <FrameCanvas source={source} frame={frame} paint={paint} label={label} onShown={onShown} />
        {last > 0 && (
          <Group gap="xs" wrap="nowrap" align="center">
            <Step
              label="Frame before"
              isDisabled={frame === 0}
              onClick={() => go(frame - 1)}
              icon={<IconPlayerSkipBack size={16} />}
            />
            <ActionIcon size="lg" aria-label={isPlaying ? "Pause" : "Play"} onClick={toggle}>
              {isPlaying ? (
                <IconPlayerPause size={18} aria-hidden />
              ) : (
                <IconPlayerPlay size={18} aria-hidden />
              )}
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
        )}
      </Stack>
    </div>
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
