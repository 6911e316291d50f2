import { Button, Group, Table, Text } from "@mantine/core";
import type { Preset } from "../client";
import { ConfirmButton } from "../platform/ConfirmButton";
import { Moment } from "../platform/Moment";
import { useDeletePreset } from "./queries";

type PresetTableProps = {
  groupId: string;
  presets: Preset[];
  mayEdit: boolean;
  onTake: (preset: Preset) => void;
};

/** The presets of a group, each to take over or to delete. */
export function PresetTable({ groupId, presets, mayEdit, onTake }: PresetTableProps) {
  return (
    <Table fz="sm" verticalSpacing="xs" aria-label="Presets">
      <Table.Tbody>
        {presets.map((preset) => (
          <Table.Tr key={preset.id}>
            <Table.Th scope="row" fw={500} style={{ overflowWrap: "anywhere" }}>
              {preset.name}
              <Text fz="xs" c="dimmed">
                {preset.saved_by && `${preset.saved_by}, `}
                <Moment time={preset.updated_at} isShort />
              </Text>
            </Table.Th>
            <Table.Td>
              <Group gap="xs" justify="flex-end" wrap="nowrap">
                {mayEdit && <Forget groupId={groupId} preset={preset} />}
                <Button size="xs" onClick={() => onTake(preset)} aria-label={`Use ${preset.name}`}>
                  Use
                </Button>
              </Group>
            </Table.Td>
          </Table.Tr>
        ))}
      </Table.Tbody>
    </Table>
  );
}

function Forget({ groupId, preset }: { groupId: string; preset: Preset }) {
  const mutation = useDeletePreset(groupId, preset.id);
  return (
    <ConfirmButton
      label="Delete"
      size="xs"
      title={`Delete ${preset.name}?`}
      action="Delete"
      mutation={{ ...mutation, mutate: (_, options) => mutation.mutate(undefined, options as never) }}
    >
      Nobody in the group finds it any more. Runs that began with it keep their parameters.
    </ConfirmButton>
  );
}
