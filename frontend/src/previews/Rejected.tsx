import { Table } from "@mantine/core";
import type { Preview } from "../client";
import { formatCount, formatNumber } from "../platform/format";
import { dropletAt } from "../results/overlay";

/** Why a candidate was not taken for a droplet, in words. */
const REASONS: Record<string, string> = {
  unlikely: "hardly looks like a droplet",
  match: "the disk does not fit the image well enough (minimum match)",
  duplicate: "a better circle is there already",
  radius: "its radius is not looked for",
};

export function whatIsAt(
  found: Pick<Preview, "x_px" | "y_px" | "r_px" | "match" | "rejected">,
  point: Parameters<typeof dropletAt>[1],
  hasRejected: boolean,
): string {
  const droplet = dropletAt(found, point);
  if (droplet !== null) {
    return `Droplet, radius ${formatNumber(found.r_px[droplet])} px, match ${formatNumber(found.match[droplet])}`;
  }
  const candidate = hasRejected ? dropletAt(found.rejected, point) : null;
  if (candidate === null) return "Nothing was found there.";
  const reason = found.rejected.reason[candidate] ?? "";
  return `Rejected: ${REASONS[reason] ?? reason} (radius ${formatNumber(found.rejected.r_px[candidate])} px)`;
}

export function Reasons({ reasons }: { reasons: string[] }) {
  const counts = new Map<string, number>();
  for (const reason of reasons) counts.set(reason, (counts.get(reason) ?? 0) + 1);
  if (counts.size === 0) return null;
  return (
    <Table fz="xs" verticalSpacing={2} aria-label="Rejected candidates by reason">
      <Table.Tbody>
        {[...counts].map(([reason, n]) => (
          <Table.Tr key={reason}>
            <Table.Th scope="row" fw={500} w={110}>
              {reason}
            </Table.Th>
            <Table.Td>{REASONS[reason] ?? ""}</Table.Td>
            <Table.Td ta="right">{formatCount(n)}</Table.Td>
          </Table.Tr>
        ))}
      </Table.Tbody>
    </Table>
  );
}
