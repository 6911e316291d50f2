import { Chip, Group } from "@mantine/core";
import { LAYER_COLOURS } from "./overlay";
import { LAYERS, type Layer } from "./view";

const TITLES: Record<Layer, string> = {
  now: "This frame",
  next: "Next frame",
  flow: "Flow from droplets",
  interpolated: "Interpolated flow",
};

/** What is drawn over the frame, each with its sign. */
export function LayerSwitches({ hidden, onToggle }: { hidden: Layer[]; onToggle: (layer: Layer) => void }) {
  return (
    <Group gap="xs" role="group" aria-label="Drawn over the frame">
      {LAYERS.map((layer) => (
        <Chip
          key={layer}
          size="xs"
          variant="outline"
          color="gray"
          checked={!hidden.includes(layer)}
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

function Sign({ layer }: { layer: Layer }) {
  const isArrow = layer === "flow" || layer === "interpolated";
  return (
    <svg width="18" height="12" aria-hidden="true" style={{ background: "#23272b", borderRadius: 3 }}>
      {isArrow ? (
        <path
          d="M3 6H15M11 3l4 3-4 3"
          fill="none"
          stroke={LAYER_COLOURS[layer]}
          strokeWidth="1.6"
          strokeLinecap="round"
        />
      ) : (
        <circle cx="9" cy="6" r="4" fill="none" stroke={LAYER_COLOURS[layer]} strokeWidth="1.6" />
      )}
    </svg>
  );
}
