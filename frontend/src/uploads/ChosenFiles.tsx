import { ActionIcon, Code, Group, Stack, Text } from "@mantine/core";
import { IconX } from "@tabler/icons-react";
import { formatBytes, plural } from "../platform/format";
import { type Found, totalBytes } from "./sorting";

const N_NAMES = 3;

/** What will be sent, as sums: a stack may have tens of thousands of files. */
export function ChosenFiles({
  frames,
  left_out,
  onClear,
}: {
  frames: Found[];
  left_out: string[];
  onClear: () => void;
}) {
  if (frames.length === 0 && left_out.length === 0) return null;
  return (
    <Stack gap={4} aria-live="polite">
      {frames.length > 0 && (
        <Group gap="xs" wrap="nowrap" justify="space-between">
          <Text fz="sm">
            <b>{plural(frames.length, "image file")}</b>, {formatBytes(totalBytes(frames))}
            <Text span c="dimmed" fz="sm">
              {" "}
              <Names names={frames.map(({ name }) => name)} />
            </Text>
          </Text>
          <ActionIcon variant="subtle" color="gray" aria-label="Take the image files out" onClick={onClear}>
            <IconX size={16} aria-hidden />
          </ActionIcon>
        </Group>
      )}
      {left_out.length > 0 && (
        <Text fz="sm" c="dimmed">
          Not images, left out: {plural(left_out.length, "file")} (<Names names={left_out} />)
        </Text>
      )}
    </Stack>
  );
}

function Names({ names }: { names: string[] }) {
  const shown = names.slice(0, N_NAMES);
  return (
    <>
      {shown.map((name, index) => (
        <span key={name}>
          {index > 0 && ", "}
          <Code>{name}</Code>
        </span>
      ))}
      {names.length > shown.length && ", …"}
    </>
  );
}
