import { SimpleGrid } from "@mantine/core";
import { type Document, valueAt, withValue } from "./document";
import { FieldInput } from "./FieldInput";
import type { Field } from "./schema";

type SchemaFormProps = {
  fields: Field[];
  document: Document;
  onChange: (document: Document) => void;
  messages: Record<string, string>;
  columns?: number;
};

/** The fields of a schema as inputs; the document is the state. */
export function SchemaForm({ fields, document, onChange, messages, columns = 1 }: SchemaFormProps) {
  return (
    <SimpleGrid cols={{ base: 1, sm: columns }} spacing="md" verticalSpacing="md">
      {fields.map((field) => (
        <FieldInput
          key={field.path}
          field={field}
          value={valueAt(document, field.path)}
          valueOf={(path) => valueAt(document, path)}
          onChange={(path, value) => onChange(withValue(document, path, value))}
          messages={messages}
        />
      ))}
    </SimpleGrid>
  );
}
