import {
  Checkbox,
  Fieldset,
  Input,
  SegmentedControl,
  SimpleGrid,
  Stack,
  TagsInput,
  Text,
} from "@mantine/core";
import { Prose } from "../platform/Prose";
import { ChoiceInput } from "./ChoiceInput";
import { branchOf } from "./check";
import { Help, Label } from "./FieldLabel";
import type { FieldInputProps } from "./inputProps";
import { NumberField } from "./NumberField";
import type { Field } from "./schema";
import { MomentInput, WordsInput } from "./TextInputs";
import { VectorInput } from "./VectorInput";

/** The input that fits a field of a schema. */
export function FieldInput(props: FieldInputProps) {
  const { field, value, onChange, messages } = props;
  const { input, path } = field;
  const common = {
    label: <Label field={field} />,
    description: <Help field={field} />,
    error: messages[path],
    required: field.isRequired,
    withAsterisk: field.isRequired,
    "data-path": path,
  };
  const change = (next: unknown) => onChange(path, next);
  switch (input.kind) {
    case "number":
      return (
        <NumberField
          {...common}
          unit={field.unit}
          placeholder={shownFallback(field)}
          value={value}
          onChange={change}
        />
      );
    case "choice":
      return <ChoiceInput {...props} options={input.options} />;
    case "flag":
      return (
        <Checkbox
          label={field.label}
          description={<Help field={field} />}
          error={messages[path]}
          checked={value === true}
          onChange={(event) => change(event.currentTarget.checked)}
        />
      );
    case "moment":
      return <MomentInput {...common} value={value} onChange={change} />;
    case "vector":
      return <VectorInput {...props} length={input.length} />;
    case "words":
      return (
        <TagsInput
          {...common}
          value={Array.isArray(value) ? value.map(String) : []}
          onChange={(words) => change(words.length ? words : undefined)}
        />
      );
    case "text":
      return <WordsInput {...common} input={input} value={value} onChange={change} />;
    case "group":
      return (
        <Fieldset legend={field.label} variant="filled">
          <Inner {...props} fields={input.fields} />
        </Fieldset>
      );
    case "either":
      return <Either {...props} branches={input.branches} />;
  }
}

function Inner({ fields, ...props }: FieldInputProps & { fields: Field[] }) {
  return (
    <SimpleGrid cols={{ base: 1, sm: 2 }} spacing="md" verticalSpacing="sm">
      {fields.map((field) => (
        <FieldInput key={field.path} {...props} field={field} value={props.valueOf(field.path)} />
      ))}
    </SimpleGrid>
  );
}

function Either({ branches, ...props }: FieldInputProps & { branches: Field[] }) {
  const { field, value, onChange, messages } = props;
  const used = branchOf(branches, value);
  const branch = branches[used];
  const choose = (label: string) => {
    const next = branches.find((one) => one.label === label);
    onChange(field.path, next?.input.kind === "group" ? {} : "");
  };
  return (
    <Fieldset legend={field.label + (field.isRequired ? " *" : "")} variant="filled">
      <Stack gap="sm">
        {field.help && (
          <Text fz="xs" c="dimmed">
            <Prose text={field.help} />
          </Text>
        )}
        <SegmentedControl
          aria-label={`How to give ${field.label.toLowerCase()}`}
          data={branches.map(({ label }) => label)}
          value={branch?.label}
          onChange={choose}
        />
        {branch?.input.kind === "group" ? (
          <Inner {...props} fields={branch.input.fields} />
        ) : (
          branch && (
            <FieldInput {...props} field={{ ...branch, label: `${field.label} name` }} value={value} />
          )
        )}
        {branch?.input.kind === "group" && messages[field.path] && (
          <Input.Error>{messages[field.path]}</Input.Error>
        )}
      </Stack>
    </Fieldset>
  );
}

function shownFallback(field: Field): string | undefined {
  return typeof field.fallback === "number" ? String(field.fallback) : undefined;
}
