import { Button, FileButton, Group, Modal, Stack, Text, Textarea } from "@mantine/core";
import { useDisclosure } from "@mantine/hooks";
import { IconClipboardText } from "@tabler/icons-react";
import { useState } from "react";
import type { Document } from "../forms/document";
import { readYaml } from "./yaml";

/** Fill the form from the text or file of an `experiment.yaml`. */
export function PasteYaml({ onDocument }: { onDocument: (document: Document) => void }) {
  const [isOpen, { open, close }] = useDisclosure(false);
  const [text, setText] = useState("");
  const [message, setMessage] = useState<string | null>(null);

  const fill = async (from: string) => {
    try {
      onDocument(await readYaml(from));
      setText("");
      setMessage(null);
      close();
    } catch (error) {
      setText(from);
      setMessage((error as Error).message);
    }
  };

  return (
    <>
      <Button
        variant="default"
        size="xs"
        leftSection={<IconClipboardText size={16} aria-hidden />}
        onClick={open}
      >
        Fill from experiment.yaml
      </Button>
      <Modal opened={isOpen} onClose={close} title="Fill from experiment.yaml" size="lg">
        <Stack>
          <Textarea
            label="Text of the file"
            description="Paste it here, or choose the file. You can correct every field afterwards."
            autosize
            minRows={8}
            maxRows={18}
            data-autofocus
            styles={{ input: { fontFamily: "var(--mantine-font-family-monospace)", fontSize: 13 } }}
            value={text}
            error={message}
            onChange={(event) => setText(event.currentTarget.value)}
          />
          <Group justify="space-between">
            <FileButton accept=".yaml,.yml,.json" onChange={async (file) => file && fill(await file.text())}>
              {(props) => (
                <Button {...props} variant="default">
                  Choose the file
                </Button>
              )}
            </FileButton>
            <Button disabled={text.trim() === ""} onClick={() => fill(text)}>
              Fill the form
            </Button>
          </Group>
          <Text fz="xs" c="dimmed">
            What the form holds now is replaced.
          </Text>
        </Stack>
      </Modal>
    </>
  );
}
