/** Numbers of Plotly's JSON: a list of them, or base64 with the type of its items. */
export function numbers(values: unknown): number[] {
  return Array.isArray(values) ? values.map(Number) : Array.from(unpacked(values));
}

function unpacked(values: unknown): ArrayLike<number> {
  const packed = values as { dtype?: string; bdata?: string } | undefined;
  const Items = packed?.dtype ? ITEMS[packed.dtype] : undefined;
  if (!packed?.bdata || !Items) return [];
  const text = atob(packed.bdata);
  const bytes = new Uint8Array(text.length);
  for (let index = 0; index < text.length; index += 1) bytes[index] = text.charCodeAt(index);
  return new Items(bytes.buffer);
}

/** The same for rows of numbers; what is no number is NaN. */
export function rows(values: unknown): ArrayLike<number>[] {
  if (Array.isArray(values))
    return values.map((row: unknown[]) => row.map((value) => (value === null ? Number.NaN : Number(value))));
  const n_columns = Number(String((values as { shape?: unknown } | undefined)?.shape ?? "").split(",")[1]);
  const all = unpacked(values);
  const n_rows = n_columns > 0 ? Math.floor(all.length / n_columns) : 0;
  return Array.from({ length: n_rows }, (_, row) =>
    Array.prototype.slice.call(all, row * n_columns, (row + 1) * n_columns),
  );
}

const ITEMS: Record<string, new (buffer: ArrayBuffer) => ArrayLike<number>> = {
  f4: Float32Array,
  f8: Float64Array,
  i1: Int8Array,
  i2: Int16Array,
  i4: Int32Array,
  u1: Uint8Array,
  u2: Uint16Array,
  u4: Uint32Array,
};
