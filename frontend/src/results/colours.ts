/** Viridis at even steps, from low to high: it reads the same with every kind of colour vision, and in print. */
const VIRIDIS = [
  "#482878",
  "#3e4a89",
  "#31688e",
  "#26828e",
  "#1f9e89",
  "#35b779",
  "#6ece58",
  "#b5de2b",
  "#fde725",
];

export type Scale = { low: number; high: number };

/** From the 2nd to the 98th percent of the values, so that one odd droplet does not take all colours. */
export function scaleOf(values: readonly number[]): Scale {
  const sorted = values.filter(Number.isFinite).sort((a, b) => a - b);
  const at = (share: number) => sorted[Math.round(share * (sorted.length - 1))] ?? 0;
  const [low, high] = [at(0.02), at(0.98)];
  return high > low ? { low, high } : { low, high: low + 1 };
}

/** Which of the colours a value has. */
export function stepOf(value: number, { low, high }: Scale): number {
  const share = (value - low) / (high - low);
  return Math.min(VIRIDIS.length - 1, Math.max(0, Math.floor(share * VIRIDIS.length)));
}

export function colourSteps(): readonly string[] {
  return VIRIDIS;
}
