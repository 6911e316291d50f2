import { Badge } from "@mantine/core";
import type { Stack } from "../client";

const LOOKS: Record<Stack["state"], { colour: string; words: string }> = {
  empty: { colour: "gray", words: "no frames yet" },
  uploading: { colour: "cyan", words: "uploading" },
  indexing: { colour: "cyan", words: "reading frames" },
  ready: { colour: "teal", words: "frames ready" },
  expired: { colour: "gray", words: "frames removed" },
  rejected: { colour: "red", words: "frames refused" },
};

export function StackBadge({ state }: { state: Stack["state"] }) {
  const { colour, words } = LOOKS[state];
  return (
    <Badge variant="light" color={colour} radius="sm" tt="none" className="state">
      {words}
    </Badge>
  );
}
