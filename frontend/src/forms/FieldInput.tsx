import {
  Autocomplete,
  Checkbox,
  Fieldset,
  Group,
  Input,
  SegmentedControl,
  Select,
  SimpleGrid,
  Stack,
  TagsInput,
  Text,
  Textarea,
  TextInput,
  VisuallyHidden,
} from "@mantine/core";
import type { ReactNode } from "react";
import { formatNumber } from "../platform/format";
import { Prose } from "../platform/Prose";
import { branchOf } from "./check";
import { NumberField } from "./NumberField";
import type { Field } from "./schema";

export type FieldInputProps = {
  field: Field;
  value: unknown;
  onChange: (path: string, value: unknown) => void;
  messages: Record<string, string>;
  valueOf: (path: string) => unknown;
};

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
      return <Choice {...props} options={input.options} />;
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
      return <WordsOrText {...common} input={input} value={value} onChange={change} />;
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

/** The label; its unit stands at the end of the input, and in the label only for those who hear it. */
function Label({ field }: { field: Field }) {
  return (
    <>
      {field.label}
      {field.unit && <VisuallyHidden> ({field.unit})</VisuallyHidden>}
    </>
  );
}

function Help({ field }: { field: Field }) {
  const { paper } = field;
  if (!field.help && !paper) return null;
  return (
    <>
      {field.help && <Prose text={field.help} />}
      {paper && (
        <>
          {" "}
          <Text span fz="inherit" style={{ whiteSpace: "nowrap" }}>
            Paper: {typeof paper.value === "number" ? formatNumber(paper.value) : String(paper.value)}
            {field.unit && ` ${field.unit}`}
            {paper.section && ` (section ${paper.section})`}.
          </Text>
        </>
      )}
    </>
  );
}

function shownFallback(field: Field): string | undefined {
  return typeof field.fallback === "number" ? String(field.fallback) : undefined;
}

const FEW = 4;

/** A few ways stand side by side; many, or an optional one, in a list that can be cleared. */
function Choice({ field, value, onChange, messages, options }: FieldInputProps & { options: string[] }) {
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

function readable(option: string): string {
  const words = option.replace(/_/g, " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}

type CommonProps = { label: ReactNode; description: ReactNode; error?: string; required: boolean };

function WordsOrText({
  input,
  value,
  onChange,
  ...common
}: CommonProps & {
  input: { isLong: boolean; suggestions: string[] };
  value: unknown;
  onChange: (value: unknown) => void;
}) {
  const text = value === undefined ? "" : String(value);
  const change = (next: string) => onChange(next === "" ? undefined : next);
  if (input.isLong) {
    return (
      <Textarea
        {...common}
        autosize
        minRows={2}
        maxRows={8}
        value={text}
        onChange={(event) => change(event.currentTarget.value)}
      />
    );
  }
  if (input.suggestions.length > 0) {
    return <Autocomplete {...common} data={input.suggestions} value={text} onChange={change} />;
  }
  return <TextInput {...common} value={text} onChange={(event) => change(event.currentTarget.value)} />;
}

/** A local date and time in, ISO 8601 with its offset out. */
function MomentInput({
  value,
  onChange,
  ...common
}: CommonProps & { value: unknown; onChange: (value: unknown) => void }) {
  const change = (local: string) => onChange(local === "" ? undefined : new Date(local).toISOString());
  return (
    <TextInput
      {...common}
      type="datetime-local"
      value={localTime(value)}
      onChange={(event) => change(event.currentTarget.value)}
    />
  );
}

function localTime(value: unknown): string {
  const time = typeof value === "string" || value instanceof Date ? new Date(value) : undefined;
  if (!time || Number.isNaN(time.getTime())) return "";
  const shifted = new Date(time.getTime() - time.getTimezoneOffset() * 60_000);
  return shifted.toISOString().slice(0, 16);
}

const AXES = ["x", "y", "z"];

function VectorInput({ field, value, onChange, messages, length }: FieldInputProps & { length: number }) {
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
