import { Badge, Button, Collapse, Stack, Text } from "@mantine/core";
import { IconChevronDown, IconChevronRight } from "@tabler/icons-react";
import { useState } from "react";
import { type Document, valueAt } from "../forms/document";
import { SchemaForm } from "../forms/SchemaForm";
import type { Field } from "../forms/schema";
import { plural } from "../platform/format";
import { Panel } from "../platform/Panel";
import { Prose } from "../platform/Prose";

type ParameterFormProps = {
  fields: Field[];
  document: Document;
  onChange: (document: Document) => void;
  messages: Record<string, string>;
};

/** Every knob, one panel a stage; the constants of a method are folded away until they are wanted. */
export function ParameterForm({ fields, ...form }: ParameterFormProps) {
  return (
    <Stack gap="md">
      {fields.map((stage) => (
        <StagePanel key={stage.path} stage={stage} {...form} />
      ))}
    </Stack>
  );
}

function StagePanel({ stage, ...form }: Omit<ParameterFormProps, "fields"> & { stage: Field }) {
  const fields = stage.input.kind === "group" ? stage.input.fields : [stage];
  const plain = fields.filter(({ input }) => input.kind !== "group");
  const nested = fields.filter(
    (field) => field.input.kind === "group" && isInUse(field, fields, form.document),
  );
  return (
    <Panel title={stage.label} about={<Prose text={stage.help} />}>
      <SchemaForm fields={plain} {...form} />
      {nested.map((group) => (
        <Constants key={group.path} group={group} {...form} />
      ))}
    </Panel>
  );
}

function Constants({ group, ...form }: Omit<ParameterFormProps, "fields"> & { group: Field }) {
  const fields = group.input.kind === "group" ? group.input.fields : [];
  const n_changed = fields.filter((field) => isChanged(field, form.document)).length;
  const hasMessage = fields.some(({ path }) => form.messages[path]);
  const [isOpened, setOpened] = useState(false);
  const isOpen = isOpened || hasMessage;
  return (
    <Stack gap="xs">
      <Button
        variant="default"
        size="xs"
        fullWidth
        styles={{ inner: { justifyContent: "flex-start" }, label: { flex: 1 } }}
        aria-expanded={isOpen}
        onClick={() => setOpened(!isOpen)}
        leftSection={
          isOpen ? <IconChevronDown size={16} aria-hidden /> : <IconChevronRight size={16} aria-hidden />
        }
        rightSection={n_changed > 0 && <Badge size="sm" tt="none">{`${n_changed} changed`}</Badge>}
      >
        {plural(fields.length, "constant")} of the method
      </Button>
      <Collapse expanded={isOpen}>
        <Stack gap="sm">
          <Text fz="xs" c="dimmed">
            <Prose text={group.help} />
          </Text>
          <SchemaForm fields={fields} {...form} />
        </Stack>
      </Collapse>
    </Stack>
  );
}

/** Constants of a method that was not chosen have no effect, and no place. */
export function isInUse(group: Field, siblings: Field[], document: Document): boolean {
  const method = siblings.find(({ name }) => name === "method");
  if (method?.input.kind !== "choice" || !method.input.options.includes(group.name)) return true;
  return valueAt(document, method.path) === group.name;
}

function isChanged({ path, fallback }: Field, document: Document): boolean {
  return fallback !== undefined && JSON.stringify(valueAt(document, path)) !== JSON.stringify(fallback);
}
