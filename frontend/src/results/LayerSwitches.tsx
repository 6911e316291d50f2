import { Chip, Group } from "@mantine/core";
import { LAYER_COLOURS } from "./overlay";
import { LAYERS, type Layer } from "./view";

const TITLES: Record<Layer, string> = {
  now: "Droplets",
  predicted: "Found by prediction",
  next: "In the next frame",
  steps: "Displacement",
  tails: "Tails",
  flow: "Flow from droplets",
  interpolated: "Interpolated flow",
  rejected: "Rejected",
};

type LayerSwitchesProps = {
  shown: readonly Layer[];
  offered: readonly Layer[];
  onToggle: (layer: Layer) => void;
};

/** What is drawn over the frame, each with its sign. */
export function LayerSwitches({ shown, offered, onToggle }: LayerSwitchesProps) {
  return (
    <Group gap={6} role="group" aria-label="Drawn over the frame">
      {LAYERS.filter((layer) => offered.includes(layer)).map((layer) => (
        <Chip
          key={layer}
          size="xs"
          variant="outline"
          color="gray"
          checked={shown.includes(layer)}
          onChange={() => onToggle(layer)}
        >
          <Group gap={6} wrap="nowrap" component="span" display="inline-flex">
            <Sign layer={layer} />
            {TITLES[layer]}
          </Group>
        </Chip>
      ))}
    </Group>
  );
}

const ARROW = "M3 6H15M11 3l4 3-4 3";
const DASHES: Partial<Record<Layer, string>> = { predicted: "2.5 2", rejected: "1 1.8" };
const LINES: Partial<Record<Layer, string>> = {
  flow: ARROW,
  interpolated: ARROW,
  steps: "M4 9L14 3",
  tails: "M3 9C6 3 9 9 15 3",
};

function Sign({ layer }: { layer: Layer }) {
  const stroke = {
    fill: "none",
    stroke: LAYER_COLOURS[layer],
    strokeWidth: 1.6,
    strokeDasharray: DASHES[layer],
  };
  return (
    <svg width="18" height="12" aria-hidden="true" style={{ background: "#23272b", borderRadius: 3 }}>
      {LINES[layer] ? (
        <path d={LINES[layer]} {...stroke} strokeLinecap="round" />
      ) : (
        <circle cx="9" cy="6" r="4" {...stroke} />
      )}
    </svg>
  );
}
