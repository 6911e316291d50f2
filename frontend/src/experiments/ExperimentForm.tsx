import { Alert, Button, Code, Collapse, Group, Stack, Text } from "@mantine/core";
import { IconChevronDown, IconChevronRight } from "@tabler/icons-react";
import { useState } from "react";
import { type Document, withValue } from "../forms/document";
import { SchemaForm } from "../forms/SchemaForm";
import type { Field } from "../forms/schema";
import { partsOf, unknownNames } from "./fields";

type ExperimentFormProps = {
  fields: Field[];
  document: Document;
  onChange: (document: Document) => void;
  messages: Record<string, string>;
};

/** What was filmed, as a form drawn from the schema. */
export function ExperimentForm({ fields, document, onChange, messages }: ExperimentFormProps) {
  const { first, more } = partsOf(fields);
  const hasHiddenMessage = more.some(({ path }) => messages[path]);
  const [isOpened, setOpened] = useState(false);
  const isOpen = isOpened || hasHiddenMessage;
  const common = { document, onChange, messages };
  return (
    <Stack gap="md">
      <UnknownFields fields={fields} document={document} onChange={onChange} />
      <SchemaForm fields={first.filter(({ input }) => input.kind !== "either")} columns={2} {...common} />
      <SchemaForm fields={first.filter(({ input }) => input.kind === "either")} {...common} />
      <div>
        <Button
          variant="subtle"
          size="compact-sm"
          aria-expanded={isOpen}
          onClick={() => setOpened(!isOpen)}
          leftSection={
            isOpen ? <IconChevronDown size={16} aria-hidden /> : <IconChevronRight size={16} aria-hidden />
          }
        >
          More about this film
        </Button>
      </div>
      <Collapse expanded={isOpen}>
        <SchemaForm fields={more} columns={2} {...common} />
      </Collapse>
    </Stack>
  );
}

/** Never dropped in silence: fields of a pasted document that this version does not know. */
function UnknownFields({ fields, document, onChange }: Omit<ExperimentFormProps, "messages">) {
  const names = unknownNames(fields, document);
  if (names.length === 0) return null;
  const leaveOut = () => onChange(names.reduce((rest, name) => withValue(rest, name, undefined), document));
  return (
    <Alert color="orange" title="Fields that are not known here">
      <Group justify="space-between">
        <Text fz="sm">
          {names.map((name, index) => (
            <span key={name}>
              {index > 0 && ", "}
              <Code>{name}</Code>
            </span>
          ))}
        </Text>
        <Button size="compact-sm" variant="default" onClick={leaveOut}>
          Leave them out
        </Button>
      </Group>
    </Alert>
  );
}
