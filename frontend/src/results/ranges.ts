import type { Range } from "./figure";

/** A range in the address: `12.5..80`. Both ends with five digits, which no screen shows. */
export function rangeToText([low, high]: Range): string {
  return `${Number(low.toPrecision(5))}..${Number(high.toPrecision(5))}`;
}

export function rangeFromText(text: string | undefined): Range | undefined {
  const [low, high, ...more] = (text ?? "").split("..").map(Number);
  const isRange = low !== undefined && high !== undefined && more.length === 0;
  return isRange && Number.isFinite(low) && Number.isFinite(high) && low !== high ? [low, high] : undefined;
}
