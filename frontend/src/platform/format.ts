/** Numbers, sizes and times as people read them. Thin spaces group digits, so that no locale mistakes them. */

const MINUS = "\u2212";
const THIN_SPACE = "\u2009";
const NOTHING = "–";

/** `12 345` */
export function formatCount(count: number | null | undefined): string {
  if (count == null || !Number.isFinite(count)) return NOTHING;
  const digits = String(Math.round(Math.abs(count)));
  const grouped = digits.length > 4 ? digits.replace(/\B(?=(\d{3})+$)/g, THIN_SPACE) : digits;
  return count < 0 ? MINUS + grouped : grouped;
}

/** A measured number with `digits` significant digits: `0.0123`, `12.3`, `4.5 × 10⁻⁶`. */
export function formatNumber(value: number | null | undefined, digits = 3): string {
  if (value == null || !Number.isFinite(value)) return NOTHING;
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-3) return formatPower(value, digits);
  const decimals = Math.max(0, digits - 1 - Math.floor(Math.log10(size)));
  const rounded = Number(value.toFixed(Math.min(decimals, 20)));
  if (Number.isInteger(rounded)) return formatCount(rounded);
  return String(rounded).replace("-", MINUS);
}

function formatPower(value: number, digits: number): string {
  const [mantissa = "", exponent = "0"] = value.toExponential(digits - 1).split("e");
  const raised = [...exponent.replace("+", "")].map((sign) => SUPERSCRIPTS[sign] ?? sign).join("");
  return `${String(Number(mantissa)).replace("-", MINUS)}${THIN_SPACE}×${THIN_SPACE}10${raised}`;
}

const SUPERSCRIPTS: Record<string, string> = {
  "-": "⁻",
  "0": "⁰",
  "1": "¹",
  "2": "²",
  "3": "³",
  "4": "⁴",
  "5": "⁵",
  "6": "⁶",
  "7": "⁷",
  "8": "⁸",
  "9": "⁹",
};

export function formatBytes(size_bytes: number | null | undefined): string {
  if (size_bytes == null) return NOTHING;
  const units = ["bytes", "kB", "MB", "GB", "TB"];
  let value = size_bytes;
  let unit = 0;
  while (value >= 1000 && unit < units.length - 1) {
    value /= 1000;
    unit += 1;
  }
  return `${unit === 0 ? formatCount(value) : value.toFixed(value < 10 ? 1 : 0)} ${units[unit]}`;
}

/** `45 s`, `3 min 20 s`, `2 h 5 min`, `3 d 4 h`: the two largest parts. */
export function formatDuration(duration_s: number | null | undefined): string {
  if (duration_s == null || !Number.isFinite(duration_s)) return NOTHING;
  if (duration_s > 0 && duration_s < 1) return `${formatNumber(duration_s, 2)} s`;
  const total_s = duration_s < 60 ? Math.round(duration_s * 10) / 10 : Math.round(duration_s);
  if (total_s < 60) return `${total_s < 10 ? total_s : Math.round(total_s)} s`;
  const parts: [number, string][] = [
    [Math.floor(total_s / 86400), "d"],
    [Math.floor(total_s / 3600) % 24, "h"],
    [Math.floor(total_s / 60) % 60, "min"],
    [Math.floor(total_s) % 60, "s"],
  ];
  const first = parts.findIndex(([count]) => count > 0);
  return parts
    .slice(first, first + 2)
    .filter(([count]) => count > 0)
    .map(([count, unit]) => `${count} ${unit}`)
    .join(" ");
}

/** `just now`, `5 min ago`, `in 3 h`, `2 days ago`; past a month the date alone tells more. */
export function formatAgo(time: string, now_ms: number): string {
  const age_s = (now_ms - Date.parse(time)) / 1000;
  const away_s = Math.abs(age_s);
  if (away_s < 45) return "just now";
  const days = Math.round(away_s / 86400);
  if (days > 30) return formatDate(time);
  const far = farAway(away_s, days);
  return age_s > 0 ? `${far} ago` : `in ${far}`;
}

function farAway(away_s: number, days: number): string {
  if (away_s < 3600) return `${Math.max(1, Math.round(away_s / 60))} min`;
  if (away_s < 86400) return `${Math.round(away_s / 3600)} h`;
  return `${days} day${days === 1 ? "" : "s"}`;
}

export function formatDate(time: string): string {
  return new Date(time).toLocaleDateString("en-GB", { day: "numeric", month: "short", year: "numeric" });
}

export function formatTime(time: string): string {
  const clock = new Date(time).toLocaleTimeString("en-GB", { hour: "2-digit", minute: "2-digit" });
  return `${formatDate(time)}, ${clock}`;
}

/** `1 frame`, `12 frames`. */
export function plural(count: number, one: string, many = `${one}s`): string {
  return `${formatCount(count)} ${count === 1 ? one : many}`;
}
