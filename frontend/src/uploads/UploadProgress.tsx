import { Button, Group, Progress, Stack, Text } from "@mantine/core";
import type { ReactNode } from "react";
import { formatBytes, formatCount, formatDuration, plural } from "../platform/format";
import { ProblemAlert } from "../platform/ProblemAlert";
import type { UploadState } from "./Upload";

const TITLES: Record<UploadState["phase"], string> = {
  sending: "Sending",
  closing: "All sent; telling the server",
  done: "All sent",
  stopped: "Stopping",
  failed: "Stopped",
};

type UploadProgressProps = { upload: UploadState; onStop: () => void; actions?: ReactNode };

/** The sending phase: bytes, rate, time left; or why it ended. */
export function UploadProgress({ upload, onStop, actions }: UploadProgressProps) {
  const percent = upload.total_bytes > 0 ? (100 * upload.sent_bytes) / upload.total_bytes : 0;
  if (upload.phase === "failed" && upload.problem) {
    return (
      <ProblemAlert
        problem={{ ...upload.problem, file: upload.problem.file ?? upload.refused }}
        title={`The upload stopped after ${formatCount(upload.n_sent)} of ${plural(upload.n_files, "file")}`}
      >
        <Group gap="xs">{actions}</Group>
      </ProblemAlert>
    );
  }
  return (
    <Stack gap={6}>
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
      <Progress.Root size="md">
        <Progress.Section value={percent} aria-label="Sending" />
      </Progress.Root>
      <Text fz="sm" className="numbers" c="dimmed">
        {formatBytes(upload.sent_bytes)} of {formatBytes(upload.total_bytes)}, {formatCount(upload.n_sent)} of{" "}
        {plural(upload.n_files, "file")}
        {upload.bytes_per_s !== null &&
          upload.phase === "sending" &&
          `, ${formatBytes(upload.bytes_per_s)}/s`}
        {upload.seconds_left !== null && `, about ${formatDuration(Math.ceil(upload.seconds_left))} left`}
      </Text>
      <Text fz="xs" c="dimmed">
        Keep this tab open while files are sent; other pages of it are fine.
      </Text>
    </Stack>
  );
}
