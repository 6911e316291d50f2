import { Alert, Button, Group, Modal, NumberInput, Progress, Stack, Text } from "@mantine/core";
import { useRef, useState } from "react";
import { formatDuration, plural } from "../platform/format";
import { type Scene, saveFile } from "./drawing";
import { canFilm, filmAsMp4 } from "./film";

type FilmDialogProps = {
  isOpen: boolean;
  onClose: () => void;
  frame: number;
  last: number;
  sceneOf: (frame: number) => Promise<Scene>;
  fileName: string;
};

const N_FRAMES = 100;

/** Which frames, how fast; then the film is drawn here in the browser. */
export function FilmDialog({ isOpen, onClose, frame, last, sceneOf, fileName }: FilmDialogProps) {
  const [first, setFirst] = useState(frame);
  const [until, setUntil] = useState(Math.min(last, frame + N_FRAMES - 1));
  const [frames_per_s, setSpeed] = useState(10);
  const [n_done, setDone] = useState<number | null>(null);
  const [problem, setProblem] = useState<string | null>(null);
  const stopping = useRef<AbortController | null>(null);
  const n_frames = Math.max(0, until - first + 1);

  const record = async () => {
    const controller = new AbortController();
    stopping.current = controller;
    setProblem(null);
    setDone(0);
    try {
      const options = {
        first,
        last: until,
        frames_per_s,
        sceneOf,
        onProgress: setDone,
        signal: controller.signal,
      };
      saveFile(await filmAsMp4(options), `${fileName}-${first}-${until}.mp4`);
      onClose();
    } catch (error) {
      if (!controller.signal.aborted) setProblem(error instanceof Error ? error.message : String(error));
    } finally {
      setDone(null);
    }
  };
  const close = () => {
    stopping.current?.abort();
    onClose();
  };

  return (
    <Modal opened={isOpen} onClose={close} title="Film of a range of frames">
      <Stack gap="md">
        <Text fz="sm" c="dimmed">
          Zoom, brightness and everything drawn over the frames are as you see them now.
        </Text>
        {!canFilm() && (
          <Alert color="orange" title="Not in this window">
            Browsers make video only on pages from this machine or over HTTPS.
          </Alert>
        )}
        <Group grow align="flex-start">
          <Whole label="First frame" value={first} min={0} max={last} onChange={setFirst} />
          <Whole label="Last frame" value={until} min={first} max={last} onChange={setUntil} />
          <Whole label="Frames a second" value={frames_per_s} min={1} max={60} onChange={setSpeed} />
        </Group>
        <Text fz="sm">
          {plural(n_frames, "frame")}, {formatDuration(n_frames / frames_per_s)} long
        </Text>
        {n_done !== null && (
          <Progress
            value={(100 * n_done) / Math.max(1, n_frames)}
            aria-label={`${n_done} of ${n_frames} frames drawn`}
          />
        )}
        {problem && (
          <Alert color="red" role="alert">
            {problem}
          </Alert>
        )}
        <Group justify="flex-end">
          <Button variant="default" onClick={close}>
            {n_done === null ? "Cancel" : "Stop"}
          </Button>
          <Button onClick={record} loading={n_done !== null} disabled={!canFilm() || n_frames < 1}>
            Make the film
          </Button>
        </Group>
      </Stack>
    </Modal>
  );
}

function Whole(props: {
  label: string;
  value: number;
  min: number;
  max: number;
  onChange: (value: number) => void;
}) {
  const { onChange, ...input } = props;
  return (
    <NumberInput
      {...input}
      allowDecimal={false}
      clampBehavior="blur"
      onChange={(value) => typeof value === "number" && onChange(value)}
    />
  );
}
