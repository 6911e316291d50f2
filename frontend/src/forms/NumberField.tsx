import { Text, TextInput } from "@mantine/core";
import { type ReactNode, useState } from "react";

type NumberFieldProps = {
  label: ReactNode;
  "aria-label"?: string;
  description?: ReactNode;
  error?: string;
  required?: boolean;
  placeholder?: string;
  unit?: string;
  value: unknown;
  onChange: (value: unknown) => void;
};

/** What a text means: a number (comma or point, `1.4e-3` too), nothing, or itself where it is neither. */
export function parseNumber(text: string): unknown {
  const plain = text
    .trim()
    .replace("−", "-")
    .replace(/^(-?\d*),(\d+)/, "$1.$2");
  if (plain === "") return undefined;
  const value = Number(plain);
  return Number.isFinite(value) ? value : text;
}

/** A number typed as people write it; what is being typed stays as typed. */
export function NumberField({ value, onChange, unit, ...props }: NumberFieldProps) {
  const [text, setText] = useState(() => textOf(value));
  const isShown = Object.is(parseNumber(text), value);
  const change = (typed: string) => {
    setText(typed);
    onChange(parseNumber(typed));
  };
  return (
    <TextInput
      {...props}
      inputMode="decimal"
      autoComplete="off"
      value={isShown ? text : textOf(value)}
      onChange={(event) => change(event.currentTarget.value)}
      rightSection={
        unit && (
          <Text fz="xs" c="dimmed" span>
            {unit}
          </Text>
        )
      }
      rightSectionWidth={unit ? 20 + unit.length * 8 : undefined}
      rightSectionPointerEvents="none"
    />
  );
}

function textOf(value: unknown): string {
  return value === undefined || value === null ? "" : String(value);
}
