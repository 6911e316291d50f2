import { Progress, Text } from "@mantine/core";
import type { Importing } from "../client";
import { formatBytes, formatDuration, plural } from "../platform/format";

/** How far the files are that are brought in. */
export function ImportProgress({ importing }: { importing: Importing }) {
  const { done_bytes, size_bytes, bytes_per_s } = importing;
  return (
    <>
      <Progress value={size_bytes > 0 ? (100 * done_bytes) / size_bytes : 0} aria-label="Files brought in" />
      <Text fz="sm" c="dimmed" className="numbers">
        {importing.mode === "copy" ? "Copying" : "Summing up"} {plural(importing.n_files, "file")} of{" "}
        {importing.root}
        {importing.path && ` / ${importing.path}`}: {formatBytes(done_bytes)} of {formatBytes(size_bytes)}
        {bytes_per_s && `, ${formatBytes(bytes_per_s)}/s`}
        {bytes_per_s && `, about ${formatDuration(Math.ceil((size_bytes - done_bytes) / bytes_per_s))} left`}
      </Text>
    </>
  );
}
