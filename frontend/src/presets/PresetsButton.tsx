import { Button, Modal, Stack, Text } from "@mantine/core";
import { useDisclosure } from "@mantine/hooks";
import { IconBookmark } from "@tabler/icons-react";
import { useQuery } from "@tanstack/react-query";
import type { Group, Preset } from "../client";
import type { Document } from "../forms/document";
import { sessionQuery } from "../people/session";
import { QueryView } from "../platform/QueryView";
import { PresetTable } from "./PresetTable";
import { parametersOf, presetsQuery } from "./queries";
import { SavePreset } from "./SavePreset";

type PresetsButtonProps = {
  group: Group;
  parameters: Document;
  defaults: Document;
  isValid: boolean;
  onTake: (parameters: Document) => void;
};

/** Parameters that a group keeps under a name: take some over, keep these, delete what is not used any more. */
export function PresetsButton({ group, parameters, defaults, isValid, onTake }: PresetsButtonProps) {
  const [isOpen, { open, close }] = useDisclosure();
  const query = useQuery({ ...presetsQuery(group.id), enabled: isOpen });
  const { data: session } = useQuery(sessionQuery);
  const own = session?.groups.find(({ id }) => id === group.id);
  const mayEdit = own !== undefined && own.right !== "view";
  const take = (preset: Preset) => {
    onTake(parametersOf(preset, defaults));
    close();
  };
  return (
    <>
      <Button variant="default" leftSection={<IconBookmark size={16} aria-hidden />} onClick={open}>
        Presets
      </Button>
      <Modal opened={isOpen} onClose={close} title={`Presets of ${group.name}`} size="lg">
        <QueryView query={query}>
          {(presets) => (
            <Stack gap="md">
              {presets.length === 0 ? (
                <Text fz="sm" c="dimmed">
                  Nothing is kept yet. A preset is a set of all parameters under a name, which everybody in{" "}
                  {group.name} finds here.
                </Text>
              ) : (
                <PresetTable groupId={group.id} presets={presets} mayEdit={mayEdit} onTake={take} />
              )}
              {mayEdit && (
                <SavePreset groupId={group.id} presets={presets} parameters={parameters} isValid={isValid} />
              )}
            </Stack>
          )}
        </QueryView>
      </Modal>
    </>
  );
}
