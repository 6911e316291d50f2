import { ActionIcon, Code, Group, Stack, Text } from "@mantine/core";
import { IconX } from "@tabler/icons-react";
import { useMemo } from "react";
import { formatBytes, plural } from "../platform/format";
import { type Found, totalBytes } from "./sorting";

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

/** The first and last of many names, in the order in which people count. */
function Names({ names }: { names: string[] }) {
  const [first, last] = useMemo(() => endsOf(names), [names]);
  return (
    <>
      <Code>{first}</Code>
      {last !== first && (
        <>
          {" "}
          … <Code>{last}</Code>
        </>
      )}
    </>
  );
}

const NATURAL = new Intl.Collator("en", { numeric: true });

export function endsOf(names: string[]): [first: string, last: string] {
  let [first = "", last = ""] = [names[0], names[0]];
  for (const name of names) {
    if (NATURAL.compare(name, first) < 0) first = name;
    if (NATURAL.compare(name, last) > 0) last = name;
  }
  return [first, last];
}
