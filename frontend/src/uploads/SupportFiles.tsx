import { ActionIcon, Button, Code, FileButton, Group, Stack, Text } from "@mantine/core";
import { IconAlertTriangle, IconX } from "@tabler/icons-react";
import { formatBytes } from "../platform/format";
import { fromList } from "./collecting";
import { type Found, NAMED_ROLES, type NamedRole } from "./sorting";

const ABOUT: Record<NamedRole, { title: string; help: string; accept: string }> = {
  flat_field: {
    title: "Flat field",
    help: "An image of the empty field of view. Frames are divided by it.",
    accept: ".tif,.tiff,.png,.jpg,.jpeg",
  },
  timestamps: {
    title: "Timestamps",
    help: "A CSV with a column time_s, one row a frame. It takes the place of the frame interval.",
    accept: ".csv",
  },
  temperature_log: {
    title: "Temperature log",
    help: "A CSV with columns time_s and temperature_c.",
    accept: ".csv",
  },
};

type SupportFilesProps = {
  /** Names that the description gives. */
  wanted: Partial<Record<NamedRole, string>>;
  chosen: Partial<Record<NamedRole, Found>>;
  onChoose: (role: NamedRole, found: Found) => void;
  /** Absent where the description cannot be changed here. */
  onRemove?: (role: NamedRole) => void;
  messages: Record<string, string>;
  roles?: NamedRole[];
};

/** The optional files beside the frames, one row a role. */
export function SupportFiles({
  wanted,
  chosen,
  onChoose,
  onRemove,
  messages,
  roles = NAMED_ROLES,
}: SupportFilesProps) {
  return (
    <Stack gap="sm">
      {roles.map((role) => {
        const { title, help, accept } = ABOUT[role];
        const found = chosen[role];
        const isMissing = wanted[role] !== undefined && !found;
        return (
          <Group key={role} justify="space-between" wrap="nowrap" align="flex-start" gap="sm">
            <div>
              <Text fz="sm" fw={500}>
                {title}
              </Text>
              <Text fz="xs" c="dimmed">
                {help}
              </Text>
              {found && (
                <Text fz="xs">
                  <Code>{found.name}</Code> {formatBytes(found.file.size)}
                </Text>
              )}
              {isMissing && (
                <Text fz="xs" c="var(--mantine-color-error)">
                  <IconAlertTriangle size={12} aria-hidden /> The description names{" "}
                  <Code>{wanted[role]}</Code>: add this file
                  {onRemove && ", or take it out"}.
                </Text>
              )}
              {messages[role] && (
                <Text fz="xs" c="var(--mantine-color-error)">
                  {messages[role]}
                </Text>
              )}
            </div>
            <Group gap={4} wrap="nowrap">
              <FileButton
                accept={accept}
                onChange={(file) => file && onChoose(role, fromList([file])[0] as Found)}
                inputProps={{ "aria-label": `${title} file` }}
              >
                {(props) => (
                  <Button
                    {...props}
                    variant="default"
                    size="compact-sm"
                    aria-label={`${found ? "Change" : "Choose"} the ${title.toLowerCase()} file`}
                  >
                    {found ? "Change" : "Choose"}
                  </Button>
                )}
              </FileButton>
              {onRemove && (found || isMissing) && (
                <ActionIcon
                  variant="subtle"
                  color="gray"
                  aria-label={`Take the ${title.toLowerCase()} out`}
                  onClick={() => onRemove(role)}
                >
                  <IconX size={16} aria-hidden />
                </ActionIcon>
              )}
            </Group>
          </Group>
        );
      })}
    </Stack>
  );
}
