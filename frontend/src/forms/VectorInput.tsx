import { Group, Input } from "@mantine/core";
import { Help, Label } from "./FieldLabel";
import type { FieldInputProps } from "./inputProps";
import { NumberField } from "./NumberField";

const AXES = ["x", "y", "z"];

/** A few numbers of one meaning, side by side. */
export function VectorInput({
  field,
  value,
  onChange,
  messages,
  length,
}: FieldInputProps & { length: number }) {
  const parts = Array.isArray(value) ? value : Array.from({ length }, () => undefined);
  const changePart = (index: number, part: unknown) => {
    const next = parts.map((old, at) => (at === index ? part : old));
    onChange(field.path, next.every((one) => one === undefined) ? undefined : next);
  };
  return (
    <Input.Wrapper
      label={<Label field={field} />}
      description={<Help field={field} />}
      error={messages[field.path]}
      withAsterisk={field.isRequired}
      labelElement="div"
    >
      <Group grow mt={4} role="group" aria-label={field.label}>
        {parts.map((part, index) => (
          <NumberField
            // biome-ignore lint/suspicious/noArrayIndexKey: the place is what tells the parts of a vector apart
            key={index}
            label={undefined}
            aria-label={`${field.label}, ${AXES[index] ?? index}`}
            unit={AXES[index]}
            value={part}
            onChange={(next) => changePart(index, next)}
          />
        ))}
      </Group>
    </Input.Wrapper>
  );
}
