import { Progress as Bar, Button, Group, Stack, Text } from "@mantine/core";
import type { ReactNode } from "react";
import { formatBytes, formatCount, formatDuration, plural } from "../platform/format";
import { ProblemAlert } from "../platform/ProblemAlert";
import { ServerAway } from "./ServerAway";
import type { Progress } from "./tally";
import type { UploadState } from "./Upload";

const TITLES: Record<UploadState["phase"], string> = {
  sending: "Uploading",
  closing: "All is there; telling the server",
  done: "All is there",
  stopped: "Stopping",
  failed: "Stopped",
};

type UploadProgressProps = {
  upload: UploadState;
  onStop: () => void;
  onTryNow: () => void;
  actions?: ReactNode;
};

/** How files get to the server, phase by phase, as sums; or why it ended. */
export function UploadProgress({ upload, onStop, onTryNow, actions }: UploadProgressProps) {
  if (upload.phase === "failed" && upload.problem) {
    return (
      <ProblemAlert
        problem={{ ...upload.problem, file: upload.problem.file ?? upload.refused }}
        title={`The upload stopped: ${formatCount(upload.sent.n_files)} of ${plural(upload.n_files, "file")} arrived and stay`}
      >
        <Group gap="xs">{actions}</Group>
      </ProblemAlert>
    );
  }
  return (
    <Stack gap="sm">
      <Group justify="space-between" gap="xs">
        <Text fw={500} fz="sm">
          {TITLES[upload.phase]}
        </Text>
        {upload.phase === "sending" && (
          <Button size="compact-sm" variant="default" onClick={onStop}>
            Stop
          </Button>
        )}
      </Group>
      {upload.away && <ServerAway away={upload.away} onTryNow={onTryNow} />}
      <Phase name="Sending" about="Only what is missing there." upload={upload} progress={upload.sent} />
      <Phase
        name="Verifying"
        about="What arrived is compared with your files."
        upload={upload}
        progress={upload.verified}
      />
      <Text fz="sm" c="dimmed">
        3. Indexing: then every frame is read once, to be sure that all can be analysed.
      </Text>
      {upload.isWaiting && (
        <Text fz="sm" role="status">
          Another tab, computer or program is sending the same files. This one waits and goes on where that
          one stops.
        </Text>
      )}
      <Text fz="xs" c="dimmed">
        Keep this tab open while files are sent; other pages of it are fine. Should it close, what arrived
        stays: drop the same files again, here or on another computer, and only the rest is sent.
      </Text>
    </Stack>
  );
}

type PhaseProps = { name: "Sending" | "Verifying"; about: string; upload: UploadState; progress: Progress };

function Phase({ name, about, upload, progress }: PhaseProps) {
  const percent = upload.total_bytes > 0 ? (100 * progress.n_bytes) / upload.total_bytes : 0;
  const left = progress.seconds_left;
  const isMoving = upload.phase === "sending" && !upload.away;
  return (
    <Stack gap={4}>
      <Group gap={6} wrap="nowrap">
        <Text fz="sm" fw={500}>
          {name === "Sending" ? "1." : "2."} {name}
        </Text>
        <Text fz="xs" c="dimmed">
          {about}
        </Text>
      </Group>
      <Bar.Root size="md">
        <Bar.Section value={percent} aria-label={name} color={name === "Sending" ? undefined : "teal"} />
      </Bar.Root>
      <Text fz="sm" className="numbers" c="dimmed">
        {formatCount(progress.n_files)} of {plural(upload.n_files, "file")}, {formatBytes(progress.n_bytes)}{" "}
        of {formatBytes(upload.total_bytes)}
        {isMoving && progress.bytes_per_s !== null && `, ${formatBytes(progress.bytes_per_s)}/s`}
        {isMoving && left !== null && `, about ${formatDuration(Math.ceil(left))} left`}
      </Text>
    </Stack>
  );
}
