import { ActionIcon, Alert, CopyButton, Group, Text, TextInput } from "@mantine/core";
import { IconCheck, IconCopy } from "@tabler/icons-react";

/** A secret or a link that is shown this once. */
export function Once({ label, value, about }: { label: string; value: string; about: string }) {
  return (
    <Alert color="teal" title={label} role="status">
      <Group wrap="nowrap" gap="xs">
        <TextInput
          aria-label={label}
          value={value}
          readOnly
          flex={1}
          styles={{ input: { fontFamily: "monospace" } }}
          onFocus={(event) => event.currentTarget.select()}
        />
        <CopyButton value={value}>
          {({ copied, copy }) => (
            <ActionIcon
              variant="default"
              size="lg"
              onClick={copy}
              aria-label={copied ? "Copied" : `Copy: ${label}`}
            >
              {copied ? <IconCheck size={16} aria-hidden /> : <IconCopy size={16} aria-hidden />}
            </ActionIcon>
          )}
        </CopyButton>
      </Group>
      <Text fz="sm" mt={6}>
        {about}
      </Text>
    </Alert>
  );
}
