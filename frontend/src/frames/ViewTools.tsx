import {
  ActionIcon,
  Button,
  Group,
  Menu,
  Popover,
  RangeSlider,
  Slider,
  Stack,
  Text,
  Tooltip,
} from "@mantine/core";
import {
  IconDownload,
  IconMovie,
  IconPhoto,
  IconSunHigh,
  IconVector,
  IconZoomIn,
  IconZoomOut,
  IconZoomReset,
} from "@tabler/icons-react";
import type { ReactNode } from "react";
import { formatNumber } from "../platform/format";
import { isPlain, PLAIN, type Tone } from "./tone";

type ViewToolsProps = {
  zoom: number;
  onZoom: (how: "closer" | "wider" | "whole") => void;
  tone: Tone;
  onTone: (tone: Tone) => void;
  onSave: (kind: "png" | "svg") => void;
  onFilm?: () => void;
  isSaving: boolean;
};

/** Zoom, brightness and export of a frame. */
export function ViewTools({ zoom, onZoom, tone, onTone, onSave, onFilm, isSaving }: ViewToolsProps) {
  return (
    <Group gap="xs" wrap="nowrap" role="toolbar" aria-label="View of the frame">
      <ActionIcon.Group>
        <Tool label="Zoom out (−)" isDisabled={zoom <= 1} onClick={() => onZoom("wider")}>
          <IconZoomOut size={18} aria-hidden />
        </Tool>
        <Tool label="Whole frame (0)" isDisabled={zoom <= 1} onClick={() => onZoom("whole")}>
          <IconZoomReset size={18} aria-hidden />
        </Tool>
        <Tool label="Zoom in (+)" onClick={() => onZoom("closer")}>
          <IconZoomIn size={18} aria-hidden />
        </Tool>
      </ActionIcon.Group>
      <Brightness tone={tone} onTone={onTone} />
      <Menu position="bottom-end" withinPortal>
        <Menu.Target>
          <Button
            variant="default"
            size="compact-md"
            h={34}
            loading={isSaving}
            leftSection={<IconDownload size={16} aria-hidden />}
          >
            Export
          </Button>
        </Menu.Target>
        <Menu.Dropdown>
          <Menu.Label>As it is seen, with scale bar</Menu.Label>
          <Menu.Item leftSection={<IconPhoto size={16} aria-hidden />} onClick={() => onSave("png")}>
            Picture (PNG)
          </Menu.Item>
          <Menu.Item leftSection={<IconVector size={16} aria-hidden />} onClick={() => onSave("svg")}>
            Drawing (SVG)
          </Menu.Item>
          {onFilm && (
            <Menu.Item leftSection={<IconMovie size={16} aria-hidden />} onClick={onFilm}>
              Film (MP4) …
            </Menu.Item>
          )}
        </Menu.Dropdown>
      </Menu>
    </Group>
  );
}

function Brightness({ tone, onTone }: { tone: Tone; onTone: (tone: Tone) => void }) {
  return (
    <Popover position="bottom-end" withinPortal trapFocus width={280}>
      <Popover.Target>
        <ActionIcon variant={isPlain(tone) ? "default" : "filled"} size={34} aria-label="Contrast and gamma">
          <IconSunHigh size={18} aria-hidden />
        </ActionIcon>
      </Popover.Target>
      <Popover.Dropdown>
        <Stack gap="sm">
          <div>
            <Text fz="sm" fw={500}>
              Contrast: black to white
            </Text>
            <RangeSlider
              min={0}
              max={1}
              step={0.01}
              minRange={0.02}
              size="sm"
              label={(value) => `${Math.round(100 * value)} %`}
              value={[tone.black, tone.white]}
              onChange={([black, white]) => onTone({ ...tone, black, white })}
              thumbFromLabel="Black below"
              thumbToLabel="White above"
            />
          </div>
          <div>
            <Text fz="sm" fw={500}>
              Gamma {formatNumber(tone.gamma, 2)}
            </Text>
            <Slider
              min={-1}
              max={1}
              step={0.05}
              size="sm"
              label={null}
              value={Math.log2(tone.gamma) / 2}
              onChange={(half) => onTone({ ...tone, gamma: 4 ** half })}
              thumbLabel="Gamma"
            />
          </div>
          <Button size="compact-sm" variant="default" disabled={isPlain(tone)} onClick={() => onTone(PLAIN)}>
            As it came
          </Button>
        </Stack>
      </Popover.Dropdown>
    </Popover>
  );
}

function Tool({
  label,
  isDisabled,
  onClick,
  children,
}: {
  label: string;
  isDisabled?: boolean;
  onClick: () => void;
  children: ReactNode;
}) {
  return (
    <Tooltip label={label} openDelay={400}>
      <ActionIcon variant="default" size={34} aria-label={label} disabled={isDisabled} onClick={onClick}>
        {children}
      </ActionIcon>
    </Tooltip>
  );
}
