import { Input, SegmentedControl, Select } from "@mantine/core";
import { Help, Label } from "./FieldLabel";
import type { FieldInputProps } from "./inputProps";
import { readable } from "./words";

const FEW = 4;

/** A few ways stand side by side; many, or an optional one, in a list that can be cleared. */
export function ChoiceInput({
  field,
  value,
  onChange,
  messages,
  options,
}: FieldInputProps & { options: string[] }) {
  const data = options.map((option) => ({ value: option, label: readable(option) }));
  const isSideBySide = options.length > 1 && options.length <= FEW && field.isRequired;
  const wrapper = {
    label: <Label field={field} />,
    description: <Help field={field} />,
    error: messages[field.path],
  };
  if (!isSideBySide) {
    return (
      <Select
        {...wrapper}
        withAsterisk={field.isRequired}
        clearable={!field.isRequired && field.fallback === undefined}
        allowDeselect={false}
        placeholder="Not said"
        data={data}
        value={value === undefined ? null : String(value)}
        onChange={(next) => onChange(field.path, next ?? undefined)}
      />
    );
  }
  return (
    <Input.Wrapper {...wrapper} withAsterisk={field.isRequired} labelElement="div">
      <SegmentedControl
        fullWidth
        mt={4}
        aria-label={field.label}
        data={data}
        value={value === undefined ? "" : String(value)}
        onChange={(next) => onChange(field.path, next)}
      />
    </Input.Wrapper>
  );
}
