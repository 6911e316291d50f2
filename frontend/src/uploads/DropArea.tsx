import { Button, FileButton, Group, Paper, Stack, Text } from "@mantine/core";
import { IconFiles, IconFolder, IconStack2 } from "@tabler/icons-react";
import { type DragEvent, useState } from "react";
import { plural } from "../platform/format";
import { collectDrop, fromList } from "./collecting";
import type { Found } from "./sorting";

/** Where a folder, files, a ZIP or a TIFF are dropped or chosen. */
export function DropArea({ onFound, hint }: { onFound: (found: Found[]) => void; hint?: string }) {
  const [isOver, setOver] = useState(false);
  const [n_seen, setSeen] = useState<number | null>(null);

  const drop = async (event: DragEvent) => {
    event.preventDefault();
    setOver(false);
    setSeen(0);
    try {
      onFound(await collectDrop(event.dataTransfer, setSeen));
    } finally {
      setSeen(null);
    }
  };

  return (
    <Paper
      p="xl"
      onDragOver={(event) => {
        event.preventDefault();
        setOver(true);
      }}
      onDragLeave={() => setOver(false)}
      onDrop={drop}
      style={{
        border: `2px dashed ${isOver ? "var(--mantine-primary-color-filled)" : "var(--mantine-color-default-border)"}`,
        background: isOver ? "var(--mantine-primary-color-light)" : "transparent",
      }}
    >
      <Stack align="center" gap="xs">
        <IconStack2 size={34} stroke={1.4} aria-hidden />
        <Text ta="center" fw={500}>
          {n_seen === null
            ? "Drop a folder, images, a film or a ZIP here"
            : `Reading the folder: ${plural(n_seen, "file")}`}
        </Text>
        <Text ta="center" fz="sm" c="dimmed">
          TIFF, PNG, JPEG or BMP; AVI, MP4 or MKV; HDF5, ND2; a Zarr as ZIP. {hint}
        </Text>
        <Group gap="xs" justify="center">
          <FileButton
            multiple
            onChange={(files) => onFound(fromList(files))}
            inputProps={{ "aria-label": "Files" }}
          >
            {(props) => (
              <Button
                {...props}
                variant="default"
                size="xs"
                leftSection={<IconFiles size={16} aria-hidden />}
              >
                Choose files
              </Button>
            )}
          </FileButton>
          <FileButton
            multiple
            onChange={(files) => onFound(fromList(files))}
            inputProps={{ webkitdirectory: "", "aria-label": "Folder" } as object}
          >
            {(props) => (
              <Button
                {...props}
                variant="default"
                size="xs"
                leftSection={<IconFolder size={16} aria-hidden />}
              >
                Choose a folder
              </Button>
            )}
          </FileButton>
        </Group>
      </Stack>
    </Paper>
  );
}
