/** Units as names carry them at their end (`pixel_size_um`, `speed_um_s`) and as people read them. */
const UNITS: Record<string, string> = {
  um_s: "µm/s",
  kg_m3: "kg/m³",
  pa_s: "Pa s",
  m_s2: "m/s²",
  um2: "µm²",
  um3: "µm³",
  um: "µm",
  px: "px",
  ms: "ms",
  s: "s",
  c: "°C",
  hz: "Hz",
  percent: "%",
  bytes: "bytes",
};

const BY_LENGTH = Object.keys(UNITS).sort((a, b) => b.length - a.length);

/** `um` or `kg/m3` as people read it; a unit we do not know stays as it is, and "1" is no unit. */
export function readableUnit(unit: string): string {
  if (unit === "1" || unit === "") return "";
  const key = unit.toLowerCase().replace(/[/ ]/g, "_");
  return UNITS[key] ?? unit.replace(/\bum\b/g, "µm");
}

/** Split `delta_density_kg_m3` into "Delta density" and "kg/m³". */
export function labelAndUnit(name: string): { label: string; unit: string } {
  const ending = BY_LENGTH.find((unit) => name.endsWith(`_${unit}`));
  const words = (ending ? name.slice(0, -ending.length - 1) : name).replace(/_/g, " ").trim();
  return { label: readableWords(words), unit: ending ? (UNITS[ending] ?? "") : "" };
}

/** Symbols as words. */
const WORDS: Record<string, string> = { "delta density": "density difference", r: "radius" };

function readableWords(words: string): string {
  const counted = (WORDS[words] ?? words).replace(/^n (.+)/, "$1").replace(/^is /, "");
  return counted.charAt(0).toUpperCase() + counted.slice(1);
}
